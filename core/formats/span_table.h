#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A labelled span of a recording, [begin, end).
struct ListedSpan {
  std::string clip;  ///< clip id, with or without "#begin-end", or the recording's name alone
  double begin = 0.0;
  double end = 0.0;
  bool in_frames = false;  ///< of the recording, counted from 0; else seconds from its first frame
  std::string label;
  std::string fine_label;
  std::string place;  ///< "file:line", for messages
};

/// A table "clip,begin_s,end_s,label" (RFC 4180, a header line; begin_frame and end_frame in the place of the seconds;
/// a column fine_label may follow, others are ignored), or a list of HumanAct12's clip names, one a line:
/// "P01G01R01F0001T0064A0101" (".npy" may follow) or its 16 digits "0111000100640101". A name is a span of a PHSPD
/// recording ("subject01_group1_time1"), both frames included, with HumanAct12's coarse and fine label. Lines that
/// begin with '#' are ignored. Errors kMalformed "name:line".
Expected<std::vector<ListedSpan>> ParseSpanTable(std::string_view bytes, const std::string& name);

}  // namespace mocurate
