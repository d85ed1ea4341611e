#include "core/formats/amc.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/row_counter.h"

namespace mocurate {
namespace {

void NoteMissing(const std::string& bone, std::size_t begin, std::size_t end, std::size_t frames,
                 const std::string& message, Amc& amc) {
  if (amc.findings.size() >= kMostAmcFindings) return;
  amc.findings.push_back(FindingOfFrames("bone_missing", static_cast<int>(begin), static_cast<int>(end),
                                         static_cast<double>(frames), message,
                                         end > begin ? FindingAction::kDropped : FindingAction::kKept));
  amc.findings.back().joint = Shown(bone);
}

}  // namespace

Status CheckMissingBones(const std::vector<int>& frame_lines, bool reports, const std::string& name, Amc& amc) {
  const auto frames = static_cast<std::size_t>(amc.frames), bones = amc.bones.size();
  std::vector<std::uint8_t> damaged(frames, 0);
  for (const int frame : amc.damaged) damaged[static_cast<std::size_t>(frame)] = 1;
  const std::size_t whole = frames - amc.damaged.size();
  std::vector<std::size_t> there(bones, 0);
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t b = 0; b < bones && damaged[f] == 0; ++b) there[b] += amc.present[f * bones + b];
  }
  const auto missing_in = [&](std::size_t frame) {
    std::vector<std::size_t> missing;
    for (std::size_t b = 0; b < bones && damaged[frame] == 0; ++b) {
      if (amc.present[frame * bones + b] == 0 && 2 * there[b] > whole) missing.push_back(b);
    }
    return missing;
  };
  for (std::size_t f = 0; f < frames; ++f) {
    const std::vector<std::size_t> missing = missing_in(f);
    if (missing.empty()) continue;
    std::size_t end = f + 1;
    while (end < frames && missing_in(end) == missing) ++end;
    const std::string& first = amc.bones[missing[0]].name;
    const auto others = static_cast<long long>(missing.size()) - 1;
    const std::string which = end == f + 1 ? "frame " + std::to_string(amc.frame_numbers[f]) + " has no"
                                           : "frames " + std::to_string(amc.frame_numbers[f]) + " to " +
                                                 std::to_string(amc.frame_numbers[end - 1]) + " have no";
    const std::string what = which + " bone '" + Shown(first) + "'" +
                             (others > 0 ? " and " + Counted(others, "other") : "") + ", which most frames have";
    const std::string place = name + ":" + std::to_string(frame_lines[f]);
    if (!reports)
      return Fail(ErrorCode::kMalformed, what, place, "correct or remove the frame, or copy the file again");
    NoteMissing(first, f, end, end - f, place + ": " + what, amc);
    for (; f < end; ++f) damaged[f] = 1;
    --f;
  }
  for (std::size_t b = 0; b < bones; ++b) {
    if (there[b] == whole || 2 * there[b] > whole) continue;
    NoteMissing(amc.bones[b].name, 0, 0, whole - there[b],
                name + ": bone '" + Shown(amc.bones[b].name) + "' is missing in " + std::to_string(whole - there[b]) +
                    " of " + std::to_string(frames) + " frames: it is left as at rest there",
                amc);
  }
  amc.damaged.clear();
  for (std::size_t f = 0; f < frames; ++f) {
    if (damaged[f] != 0) amc.damaged.push_back(static_cast<int>(f));
  }
  return {};
}

Status LeaveAmcGaps(const std::string& name, const std::function<Status(std::size_t)>& fits, Amc& amc) {
  const std::vector<int> numbers = amc.frame_numbers;
  int least = 0;
  for (std::size_t f = 1; f < numbers.size(); ++f) {
    const int step = numbers[f] - numbers[f - 1];
    if (step < 1) return {};
    least = least == 0 ? step : std::min(least, step);
  }
  if (least == 0) return {};
  const Expected<RowPlaces> places = PlacesByNumber({numbers.begin(), numbers.end()}, least, name);
  if (!places) return Forward(places);
  if (places->place.empty() || places->every_row()) return {};
  const auto frames = static_cast<std::size_t>(places->frames()), rows = numbers.size();
  if (Status memory = fits(frames); !memory) return memory;
  const auto channels = static_cast<std::size_t>(amc.channel_count), bones = amc.bones.size();
  const auto at = [&](std::size_t row) { return static_cast<std::size_t>(places->place[row]); };
  std::vector<double> values(frames * channels, 0.0);
  std::vector<std::uint8_t> present(frames * bones, 0), missing(frames, 1);
  amc.frame_numbers.resize(frames);
  for (std::size_t f = 0; f < frames; ++f) amc.frame_numbers[f] = numbers[0] + static_cast<int>(f) * least;
  for (std::size_t row = 0; row < rows; ++row) {
    missing[at(row)] = 0;
    std::copy_n(amc.values.begin() + static_cast<std::ptrdiff_t>(row * channels), channels,
                values.begin() + static_cast<std::ptrdiff_t>(at(row) * channels));
    std::copy_n(amc.present.begin() + static_cast<std::ptrdiff_t>(row * bones), bones,
                present.begin() + static_cast<std::ptrdiff_t>(at(row) * bones));
  }
  for (const int row : amc.damaged) missing[at(static_cast<std::size_t>(row))] = 1;
  const auto is_gap = [&](const Finding& finding) {
    const auto row = static_cast<std::size_t>(finding.frame_begin);
    return finding.code == "frame_number" && row > 0 && row < rows && at(row) > at(row - 1) + 1;
  };
  amc.findings.erase(std::remove_if(amc.findings.begin(), amc.findings.end(), is_gap), amc.findings.end());
  MoveFindings(*places, amc.findings);
  for (std::size_t row = 1; row < rows && amc.findings.size() < kMostAmcFindings; ++row) {
    const auto skipped = static_cast<long long>(at(row) - at(row - 1)) - 1;
    if (skipped == 0) continue;
    amc.findings.push_back(
        FindingOfFrames("time_gap", places->place[row - 1] + 1, places->place[row], static_cast<double>(skipped),
                        name + ": " + Counted(skipped, "frame") + " without a pose: number " +
                            std::to_string(numbers[row - 1]) + " is followed by " + std::to_string(numbers[row]),
                        FindingAction::kDropped));
  }
  amc.frames = static_cast<int>(frames);
  amc.values = std::move(values);
  amc.present = std::move(present);
  amc.damaged.clear();
  for (std::size_t f = 0; f < frames; ++f) {
    if (missing[f] != 0) amc.damaged.push_back(static_cast<int>(f));
  }
  return {};
}

}  // namespace mocurate
