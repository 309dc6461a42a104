#include "cli/signals.hpp"

#include "cli/console.hpp"
#include "hyperiso/io.hpp"

#include <csignal>
#include <unistd.h>

namespace hyperiso::cli {
namespace {

extern "C" void end_program(int signal) {
  remove_unfinished_files();
  wipe_progress_bar();
  ::_exit(128 + signal);
}

} // namespace

void install_signal_handlers() {
  struct sigaction action {};
  ::sigfillset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // What the caller ignores (nohup) stays ignored.
    struct sigaction current {};
    ::sigaction(signal, nullptr, &current);
    if (current.sa_handler == SIG_IGN) continue;
    action.sa_handler = end_program;
    ::sigaction(signal, &action, nullptr);
  }
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN); // past the largest size of a file (ulimit -f) a write fails instead
}

} // namespace hyperiso::cli
