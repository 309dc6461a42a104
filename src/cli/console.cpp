#include "cli/console.hpp"

#include "cli/failure.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <system_error>
#include <unistd.h>

namespace hyperiso::cli {
namespace {

// All of it or an error number.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

constexpr std::string_view wipe_line = "\r\033[K";
std::atomic<bool> bar_is_shown{false};

void print_message(std::string_view kind, std::string_view message) {
  std::string line = fmt::format("hyperiso: {}: {}", kind, message);
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < 32 || c == 127; }, ' ');
  while (line.back() == ' ') line.pop_back();
  wipe_progress_bar();
  write_all(STDERR_FILENO, line + '\n');
}

} // namespace

void print(std::string_view text) {
  const int problem = write_all(STDOUT_FILENO, text);
  if (problem == EPIPE) throw ReaderGone{};
  if (problem != 0)
    throw Failure{
        {Code::file_unwritable, hyperiso::text("cannot write to standard output: ", std::strerror(problem))}};
}

void print_json(const Json& object) {
  // Names come from files and may be any bytes; JSON must be UTF-8.
  print(object.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n');
}

void print_error(std::string_view message) { print_message("error", message); }
void print_warning(std::string_view message) { print_message("warning", message); }

void print_usage(std::string_view lines) { write_all(STDERR_FILENO, lines); }

std::string grouped(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string groups;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) groups += ',';
    groups += digits[i];
  }
  return groups;
}

std::string seconds(double duration) {
  return fmt::format("{:.{}f} s", duration, duration < 0.0995 ? 3 : duration < 9.95 ? 2 : 1);
}

std::string Report::text() const {
  std::size_t width = 0;
  for (const auto& [label, value] : rows_) width = std::max(width, label.size());
  std::string lines;
  for (const auto& [label, value] : rows_) lines += fmt::format("{:<{}}  {}\n", label, width, value);
  return lines;
}

ProgressBar::ProgressBar(std::string label, bool quiet) : label_(std::move(label)) {
  if (quiet || !::isatty(STDERR_FILENO)) return;
  // Signals are for the thread that works: their handler must not run beside it.
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    drawing_ = std::thread([this] { keep_drawing(); });
  } catch (const std::system_error&) { // no thread to be had: the work goes on without a bar
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

ProgressBar::~ProgressBar() {
  if (!drawing_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  ended_.notify_one();
  drawing_.join();
  wipe_progress_bar();
}

void ProgressBar::keep_drawing() {
  constexpr std::chrono::milliseconds delay{300}, interval{100};
  std::unique_lock lock(mutex_);
  const auto has_ended = [this] { return has_ended_; };
  if (ended_.wait_for(lock, delay, has_ended)) return;
  do draw();
  while (!ended_.wait_for(lock, interval, has_ended));
}

void ProgressBar::draw() const {
  const double share = share_;
  std::string line = fmt::format("{}{} ", wipe_line, label_);
  if (share < 0) {
    line += fmt::format("{:.1f} s", since_start_.seconds());
  } else {
    constexpr std::size_t width = 40;
    const auto filled = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * width);
    line += fmt::format("[{:<{}}] {:3.0f} %", std::string(filled, '#'), width, share * 100);
  }
  bar_is_shown = true;
  write_all(STDERR_FILENO, line);
}

void wipe_progress_bar() noexcept {
  if (bar_is_shown.exchange(false)) write_all(STDERR_FILENO, wipe_line);
}

} // namespace hyperiso::cli
