#include "ingest/inspect/frame_names.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "core/base/text.h"
#include "ingest/sources/frame_files.h"

namespace mocurate {
namespace {

/// The name with '#' for its last number, and the number.
std::optional<std::pair<std::string, long long>> Numbered(const std::string& name) {
  constexpr const char* kDigits = "0123456789";
  const std::size_t slash = name.rfind('/') + 1;  // 0 without one
  const std::size_t last = name.find_last_of(kDigits);
  if (last == std::string::npos || last < slash) return std::nullopt;
  const std::size_t before = name.find_last_not_of(kDigits, last);
  const std::size_t begin = std::max(slash, before == std::string::npos ? 0 : before + 1);
  const auto number = ParseInteger(name.substr(begin, last + 1 - begin));
  if (!number) return std::nullopt;
  return std::pair(name.substr(0, begin) + '#' + name.substr(last + 1), static_cast<long long>(*number));
}

}  // namespace

long long FrameNames::Sequence::first() const {
  return broken.empty() ? files.begin()->first : std::min(files.begin()->first, broken.begin()->first);
}

long long FrameNames::Sequence::last() const {
  return broken.empty() ? files.rbegin()->first : std::max(files.rbegin()->first, broken.rbegin()->first);
}

void FrameNames::Add(const std::string& name) {
  const auto numbered = Numbered(name);
  if (!numbered) return;
  const auto [first, fresh] = sequences_[numbered->first].files.emplace(numbered->second, name);
  if (!fresh) twice_.emplace_back(name, first->second);
}

bool FrameNames::AddBroken(const std::string& name, const Error& error) {
  const auto numbered = Numbered(name);
  const auto sequence = numbered ? sequences_.find(numbered->first) : sequences_.end();
  if (sequence == sequences_.end()) return false;
  sequence->second.broken.emplace(numbered->second, std::pair(name, error));
  return true;
}

std::vector<Finding> FrameNames::MissingFrames(const std::vector<const FrameNames*>& beside) const {
  std::map<std::pair<long long, long long>, int> spans;
  for (const FrameNames* names : beside) {
    for (const auto& [key, sequence] : names->sequences()) ++spans[{sequence.first(), sequence.last()}];
  }
  std::vector<Finding> findings;
  for (const auto& [name, other] : twice_) {
    findings.push_back(MakeFinding(
        "malformed", Severity::kError, 0.0,
        name + ": the same frame as " + other + " (one file per camera and frame is expected: leave one of them out)"));
  }
  for (const auto& [key, sequence] : sequences_) {
    long long first = sequence.first(), last = sequence.last();
    const auto common = std::find_if(spans.begin(), spans.end(), [&](const auto& span) {
      return span.second >= 2 && span.first.first <= first && span.first.second >= last;
    });
    if (common != spans.end()) std::tie(first, last) = common->first;
    // Numbers that count no frames: of takes, or of other things.
    if (last - first >= 2 * static_cast<long long>(sequence.files.size() + sequence.broken.size())) continue;
    MissingFrameList lacking;
    for (long long number = first; number <= last; ++number) {
      const int frame = static_cast<int>(number - first);
      const auto broken = sequence.broken.find(number);
      if (broken != sequence.broken.end()) {
        lacking.broken.push_back(frame);
        lacking.problems.push_back(broken->second);
      } else if (sequence.files.count(number) == 0) {
        lacking.missing.push_back(frame);
      }
    }
    NoteMissingFrames("", {first, static_cast<int>(last - first + 1)}, lacking, findings);
  }
  return findings;
}

}  // namespace mocurate
