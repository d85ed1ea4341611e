#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <string>

namespace mocurate {

/// In a run folder: the items at work.
inline constexpr const char* kProgressFile = "progress.json";

/// How far a stage is: on a terminal a line, rewritten in place on stderr; elsewhere a line a minute of each item that
/// reports it. Items at work are also recorded in a file that `inspect RUN` reads: {"stage", "items": [{"item",
/// "share", "text", "time"}]}.
class Progress {
 public:
  /// `file`: removed at the end, and where it cannot be written there is none; empty: no file.
  Progress(std::string stage, std::size_t items, bool wanted, std::filesystem::path file = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Count(const std::string& item, bool executed, bool failed);
  /// How far an item inside is; shown when few items are in work.
  void Detail(const std::string& item, double fraction, const std::string& text);
  void Draw();
  /// Takes the line away, so that something else can be printed.
  void Clear();

  /// "12/40, 3.1/s, 9 s to go, 1 failed"
  std::string Text() const;

 private:
  struct Item {
    double share = 0.0;
    std::string text, time;
    std::chrono::steady_clock::time_point logged = std::chrono::steady_clock::now();
  };
  void WriteRecord();
  void RemoveRecord() const;

  std::string stage_;
  std::size_t items_;
  std::filesystem::path file_;
  bool logged_, shown_;
  std::size_t finished_ = 0, executed_ = 0, failed_ = 0;
  std::map<std::string, Item> at_work_;
  std::string detail_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_draw_, last_written_;
};

}  // namespace mocurate
