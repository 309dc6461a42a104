#pragma once
// Everything that is printed: results on standard output, messages and the progress bar on standard error.

#include "hyperiso/progress.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace hyperiso::cli {

using Json = nlohmann::ordered_json; // keeps the order in which keys are added

// Thrown where nobody reads standard output any more (`hyperiso ... | head`): no error, only the end.
struct ReaderGone {};

// Writes to standard output, at once. Throws Failure if that fails, ReaderGone on a broken pipe.
void print(std::string_view text);
void print_json(const Json& object);

// One line on standard error: control characters are shown as spaces.
void print_error(std::string_view message);
void print_warning(std::string_view message);

// Lines on standard error as they are.
void print_usage(std::string_view lines);

std::string grouped(std::uint64_t number); // 856960 -> "856,960"
std::string seconds(double duration);      // "0.35 s"

// Lines of "label   value" in two columns.
class Report {
 public:
  void add(std::string label, std::string value) { rows_.emplace_back(std::move(label), std::move(value)); }
  std::string text() const;

 private:
  std::vector<std::pair<std::string, std::string>> rows_;
};

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A line on standard error that says what is being done and how far it is or, where that is not known, for
// how long; only if standard error is a terminal. It appears after a moment, so that quick work shows
// nothing, and is wiped away at the end.
class ProgressBar {
 public:
  ProgressBar(std::string label, bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double share) { share_ = share; }
  Progress callback() {
    return [this](double share) { return show(share), true; };
  }

 private:
  void draw() const;
  void keep_drawing();

  std::string label_;
  std::atomic<double> share_{-1}; // not known
  Stopwatch since_start_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::thread drawing_; // a thread of its own, as reading and writing have nothing to tell
};

// Wipes a progress bar from within a signal handler.
void wipe_progress_bar() noexcept;

} // namespace hyperiso::cli
