// Signals that ask a run to write a checkpoint and end: SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGXCPU, SIGUSR1, SIGUSR2;
// and those that end it at once.
#pragma once

namespace eulastic {

/// Local. Call after PetscInitialize, which has handlers of its own. A second SIGINT ends the process at once; a signal
/// that the process was told to ignore, as nohup does with SIGHUP, stays ignored.
void catch_signals();
/// Local. SIGSEGV, SIGFPE, SIGABRT and the like: one line, then all ranks end. Call after PetscInitialize.
void catch_faults();
/// Local: whether this process has received a signal. All ranks must agree before they act on it.
bool signal_caught();

}  // namespace eulastic
