#include "core/formats/uestc_info.h"

#include <functional>
#include <optional>
#include <set>
#include <tuple>

#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr int kActions = 40, kViews = 9, kSubjects = 118, kSides = 2;
constexpr int kMostFrames = 10'000'000;

struct NamePart {
  const char* name;
  char letter;
  int least, most;
  int UestcVideo::*member;
};

constexpr NamePart kNameParts[] = {{"action", 'a', 0, kActions - 1, &UestcVideo::action},
                                   {"view", 'd', 0, kViews - 1, &UestcVideo::view},
                                   {"subject", 'p', 1, kSubjects, &UestcVideo::subject},
                                   {"side", 'c', 1, kSides, &UestcVideo::side}};

auto TiedVideo(const UestcVideo& v) { return std::tie(v.action, v.view, v.subject, v.side); }

/// Lines that are counted: none may be empty but those at the end.
Status EachLine(LineReader& lines, const std::string& what, const std::function<Status(std::string_view)>& take) {
  int count = 0;
  for (std::string_view line = lines.Next(); !line.empty(); line = lines.Next()) {
    if (lines.number() != ++count) {
      return lines.Bad("an empty line precedes '" + Shown(line) + "'", what + " are counted by lines");
    }
    if (Status taken = take(line); !taken) return taken;
  }
  if (count == 0) return Fail(ErrorCode::kMalformed, "the file holds no " + what, lines.name(), "is the file empty?");
  return {};
}

}  // namespace

bool operator==(const UestcVideo& a, const UestcVideo& b) { return TiedVideo(a) == TiedVideo(b); }

std::string UestcVideo::Name() const {
  return "a" + std::to_string(action) + "_d" + std::to_string(view) + "_p" + ZeroPadded(subject, 3) + "_c" +
         std::to_string(side) + "_color.avi";
}

Expected<UestcVideo> ParseUestcName(std::string_view text, const std::string& where) {
  const std::vector<std::string_view> parts = SplitText(text, '_');
  UestcVideo video;
  for (std::size_t i = 0; i < 4; ++i) {
    const NamePart& field = kNameParts[i];
    const std::string_view part = i < parts.size() ? parts[i] : std::string_view();
    const bool digits = part.size() > 1 && part.substr(1).find_first_not_of("0123456789") == std::string_view::npos;
    const std::optional<long long> number =
        digits && part.front() == field.letter ? ParseInteger(part.substr(1)) : std::nullopt;
    if (!number || *number < field.least || *number > field.most) {
      return Fail(ErrorCode::kMalformed,
                  "'" + Shown(part) + "' in '" + Shown(text) + "' is not a valid " + field.name + ": " + field.letter +
                      " and a number from " + std::to_string(field.least) + " to " + std::to_string(field.most),
                  where, "as in a12_d4_p007_c2_color.avi");
    }
    video.*field.member = static_cast<int>(*number);
  }
  return video;
}

Expected<std::vector<UestcVideo>> ParseUestcNames(std::string_view bytes, const std::string& name) {
  std::vector<UestcVideo> videos;
  std::set<std::tuple<int, int, int, int>> seen;
  LineReader lines(bytes, name);
  const Status read = EachLine(lines, "names", [&](std::string_view line) -> Status {
    const Expected<UestcVideo> video = ParseUestcName(line, lines.Place());
    if (!video) return Forward(video);
    if (line.size() < 10 || line.substr(line.size() - 10) != "_color.avi") {
      return lines.Bad("'" + Shown(line) + "' does not end in _color.avi");
    }
    if (!seen.insert(TiedVideo(*video)).second) return lines.Bad("'" + Shown(line) + "' appears twice");
    videos.push_back(*video);
    return {};
  });
  if (!read) return Forward(read);
  return videos;
}

Expected<std::vector<int>> ParseUestcFrameCounts(std::string_view bytes, const std::string& name, std::size_t videos) {
  std::vector<int> frames;
  LineReader lines(bytes, name);
  const Status read = EachLine(lines, "frame counts", [&](std::string_view line) -> Status {
    const std::optional<long long> count = ParseInteger(line);
    if (!count || *count < 0 || *count > kMostFrames)
      return lines.Bad("'" + Shown(line) + "' is not a count of frames");
    frames.push_back(static_cast<int>(*count));
    return {};
  });
  if (!read) return Forward(read);
  if (videos != 0 && frames.size() != videos) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(frames.size()) + " frame counts are given for " + std::to_string(videos) + " names",
                lines.Place(), "the two files are not of one set, or one is cut off");
  }
  return frames;
}

Expected<std::vector<std::string>> ParseUestcActions(std::string_view bytes, const std::string& name) {
  std::vector<std::string> actions;
  std::set<std::string> seen;
  LineReader lines(bytes, name);
  const Status read = EachLine(lines, "action classes", [&](std::string_view line) -> Status {
    if (!seen.insert(std::string(line)).second) return lines.Bad("action '" + Shown(line) + "' appears twice");
    actions.emplace_back(line);
    return {};
  });
  if (!read) return Forward(read);
  if (actions.size() != kActions) {
    return Fail(ErrorCode::kInconsistent, std::to_string(actions.size()) + " action classes, the set has 40",
                lines.Place());
  }
  return actions;
}

std::string WriteUestcNames(const std::vector<UestcVideo>& videos) {
  std::string text;
  for (const UestcVideo& video : videos) text += video.Name() + "\n";
  return text;
}

std::string WriteUestcFrameCounts(const std::vector<int>& frames) {
  std::string text;
  for (const int count : frames) text += std::to_string(count) + "\n";
  return text;
}

}  // namespace mocurate
