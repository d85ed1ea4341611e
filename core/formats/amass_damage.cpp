#include "core/formats/amass_damage.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/text.h"
#include "core/formats/largest_number.h"

namespace mocurate {
namespace {

bool IsSound(double value) { return std::isfinite(value) && std::abs(value) <= kLargestNumber; }

/// Arrays of one row a frame that make the motion.
std::vector<NpzMember*> MotionArrays(Npz& npz) {
  std::vector<NpzMember*> arrays;
  for (NpzMember& member : npz.members) {
    const NpyArray& array = member.array;
    const bool motion = member.name == "poses" || member.name == "trans" || member.name == "root_orient" ||
                        member.name.rfind("pose_", 0) == 0;
    const bool rows = array.shape.size() == 2 && array.values.size() == array.shape[0] * array.shape[1];
    if (motion && rows) arrays.push_back(&member);
  }
  return arrays;
}

}  // namespace

DamagedPoses ClearDamaged(Npz& npz) {
  DamagedPoses damaged;
  for (const NpzMember* member : MotionArrays(npz)) {
    const std::vector<double>& values = member->array.values;
    for (std::size_t at = 0, wide = member->array.shape[1]; at < values.size(); ++at) {
      if (IsSound(values[at])) continue;
      const auto frame = static_cast<int>(at / wide);
      ++damaged.in_frame[frame];
      damaged.first.emplace(frame, member->name + "[" + std::to_string(frame) + ", " + std::to_string(at % wide) +
                                       "] is " + (std::isnan(values[at]) ? "NaN" : FormatDouble(values[at])));
    }
  }
  for (NpzMember* member : MotionArrays(npz)) {
    const auto wide = static_cast<std::ptrdiff_t>(member->array.shape[1]);
    for (const auto& [frame, numbers] : damaged.in_frame) {
      if (static_cast<std::size_t>(frame) >= member->array.shape[0]) continue;
      std::fill_n(member->array.values.begin() + frame * wide, wide, 0.0);
    }
  }
  return damaged;
}

void ReportDamaged(const DamagedPoses& damaged, const std::string& name, Amass& amass) {
  constexpr std::size_t kMostFindings = 200;
  for (const auto& [frame, numbers] : damaged.in_frame) {
    const bool follows = !amass.damaged.empty() && amass.damaged.back() + 1 == frame;
    amass.damaged.push_back(frame);
    if (follows && !amass.findings.empty() && amass.findings.back().frame_end == frame) {
      amass.findings.back().frame_end = frame + 1;
      amass.findings.back().value += static_cast<double>(numbers);
      continue;
    }
    if (amass.findings.size() >= kMostFindings) continue;
    Finding finding;
    finding.code = "not_a_number";
    finding.frame_begin = frame;
    finding.frame_end = frame + 1;
    finding.value = static_cast<double>(numbers);
    finding.message = damaged.first.at(frame);
    finding.action = FindingAction::kDropped;
    amass.findings.push_back(std::move(finding));
  }
  for (Finding& finding : amass.findings) {
    finding.message = name + ": " + Counted(static_cast<long long>(finding.value), "number") + " of " +
                      Counted(finding.frame_end - finding.frame_begin, "frame") +
                      (finding.value > 1.0 ? " are implausible, the first: " : " is implausible: ") + finding.message;
  }
}

}  // namespace mocurate
