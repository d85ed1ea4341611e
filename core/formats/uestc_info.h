#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A video of UESTC, "a12_d4_p007_c2_color.avi".
struct UestcVideo {
  int action = 0;   ///< 0 to 39
  int view = 0;     ///< 0 to 8; 8 is the moving camera
  int subject = 0;  ///< 1 to 118
  int side = 0;     ///< 1: the front camera; 2: the other

  /// The name as the set writes it.
  std::string Name() const;
};

bool operator==(const UestcVideo& a, const UestcVideo& b);

/// One name with its ending or without ("a12_d4_p007_c2_skeleton.mat" is of the same video). Error kMalformed naming
/// the field. `where` is for the message.
Expected<UestcVideo> ParseUestcName(std::string_view text, const std::string& where);

/// info/names.txt: a name a line; the line's place is the index of the video in every other file of the set. Error
/// kMalformed "name:line" that names the field: out of range, an empty line between names, a name twice. The released
/// set has 25,600.
Expected<std::vector<UestcVideo>> ParseUestcNames(std::string_view bytes, const std::string& name);

/// info/num_frames_min.txt: frames of each video, one a line, at least 0. Error as above, and kInconsistent where
/// `videos` is not 0 and not their count.
Expected<std::vector<int>> ParseUestcFrameCounts(std::string_view bytes, const std::string& name,
                                                 std::size_t videos = 0);

/// info/action_classes.txt: the words of action 0, 1, ... Error as above, and kInconsistent where there are not 40.
Expected<std::vector<std::string>> ParseUestcActions(std::string_view bytes, const std::string& name);

std::string WriteUestcNames(const std::vector<UestcVideo>& videos);
std::string WriteUestcFrameCounts(const std::vector<int>& frames);

}  // namespace mocurate
