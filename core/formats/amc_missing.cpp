#include "core/formats/amc_missing.h"

#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

void NoteMissing(const std::string& bone, std::size_t begin, std::size_t end, std::size_t frames,
                 const std::string& message, Amc& amc) {
  if (amc.findings.size() >= kMostAmcFindings) return;
  Finding& finding = amc.findings.emplace_back();
  finding.code = "bone_missing";
  finding.joint = Shown(bone);
  finding.frame_begin = static_cast<int>(begin);
  finding.frame_end = static_cast<int>(end);
  finding.value = static_cast<double>(frames);
  finding.message = message;
  finding.action = end > begin ? FindingAction::kDropped : FindingAction::kKept;
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

}  // namespace mocurate
