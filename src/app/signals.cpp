#include "app/signals.hpp"

#include <csignal>

namespace eulastic {
namespace {

volatile std::sig_atomic_t caught = 0;

void remember(int) { caught = 1; }

void handle(int signal, int flags) {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = SA_RESTART | flags;
  (void)sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_signals() {
  handle(SIGUSR1, 0);
  handle(SIGTERM, 0);
  handle(SIGINT, static_cast<int>(SA_RESETHAND));
  (void)std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error we report
}

bool signal_caught() { return caught != 0; }

}  // namespace eulastic
