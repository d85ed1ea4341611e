#include "core/base/problem_list.h"

#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostShown = 50;
constexpr std::size_t kMostListed = 16;

}  // namespace

void ProblemList::Add(std::string where, std::string what, std::string hint) {
  Add(std::move(where), std::move(what), [&hint] { return std::move(hint); });
}

void ProblemList::Add(std::string where, std::string what, const std::function<std::string()>& hint) {
  if (problems_.size() == kMostShown) {
    ++more_;
    return;
  }
  problems_.push_back({ErrorCode::kConfig, std::move(what), std::move(where), hint()});
}

Status ProblemList::Result() const {
  if (problems_.empty()) return {};
  if (problems_.size() == 1) return tl::unexpected<Error>(problems_.front());
  std::string lines;
  for (const Error& problem : problems_) lines += (lines.empty() ? "" : "\n") + problem.Message();
  if (more_ > 0) lines += "\nand " + std::to_string(more_) + " more";
  return Fail(ErrorCode::kConfig, lines);
}

std::string HintFor(const std::string& word, const std::vector<std::string>& known) {
  const bool listed = !known.empty() && known.size() <= kMostListed;
  return DidYouMean(word, known, listed ? "known here: " + JoinTexts(known) : "");
}

}  // namespace mocurate
