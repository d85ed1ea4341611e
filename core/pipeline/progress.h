#pragma once

#include <chrono>
#include <string>

namespace mocurate {

/// The progress line of a stage; shown on a terminal only, rewritten in place on stderr.
class Progress {
 public:
  Progress(std::string stage, std::size_t items, bool wanted);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Count(bool executed, bool failed);
  /// How far an item inside is; shown when few items are in work.
  void Detail(double fraction, const std::string& text);
  void Draw();
  /// Takes the line away, so that something else can be printed.
  void Clear();

  /// "12/40, 3.1/s, 9 s to go, 1 failed"
  std::string Text() const;

 private:
  std::string stage_;
  std::size_t items_;
  bool shown_;
  std::size_t finished_ = 0, executed_ = 0, failed_ = 0;
  std::string detail_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace mocurate
