#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"

namespace mocurate {

/// Names of files of one frame each: the last number in a name is the frame's. Files whose names differ in another
/// place as well are of different sequences.
class FrameNames {
 public:
  struct Sequence {
    std::map<long long, std::string> files;                     ///< by number
    std::map<long long, std::pair<std::string, Error>> broken;  ///< that could not be read
    long long first() const;
    long long last() const;
  };

  /// A name without a number is skipped.
  void Add(const std::string& name);
  /// False where no sequence has such names.
  bool AddBroken(const std::string& name, const Error& error);
  const std::map<std::string, Sequence>& sequences() const { return sequences_; }

  /// "frames_missing" and "unreadable_frames", as a run tells them; "malformed" of files of one frame. Frames that are
  /// missing at the ends are those that at least two of `beside`, views of the same recording, both begin and end with.
  std::vector<Finding> MissingFrames(const std::vector<const FrameNames*>& beside) const;

 private:
  std::vector<std::pair<std::string, std::string>> twice_;  ///< and the file that has the frame already
  std::map<std::string, Sequence> sequences_;               ///< by the name with '#' for the number
};

}  // namespace mocurate
