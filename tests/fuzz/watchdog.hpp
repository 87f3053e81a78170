// Names the case under way when it crashes or does not end.
#pragma once

#include <sys/time.h>
#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <string>

extern "C" void __sanitizer_set_death_callback(void (*)()) __attribute__((weak));  // NOLINT: its name

namespace eulastic::fuzz {

inline std::string &present = *new std::string;  ///< the case under way; outlives everything

inline void say_case(int signal) {
  (void)!write(2, present.data(), present.size());
  if (signal == SIGALRM || signal == SIGPROF) (void)!write(2, "\nfuzz: more than a minute\n", 26);
  std::_Exit(1);
}

inline void say_case_at_death() {
  for (int signal : {SIGALRM, SIGPROF, SIGABRT, SIGSEGV, SIGFPE, SIGBUS}) (void)std::signal(signal, say_case);
  if (__sanitizer_set_death_callback)
    __sanitizer_set_death_callback([] { (void)!write(2, present.data(), present.size()); });
}

/// A case may take a minute of work, or ten of waiting: the machine may be busy.
inline void watch(bool on) {
  const itimerval minute{{0, 0}, {on ? 60 : 0, 0}};
  (void)setitimer(ITIMER_PROF, &minute, nullptr);
  alarm(on ? 600 : 0);
}

}  // namespace eulastic::fuzz
