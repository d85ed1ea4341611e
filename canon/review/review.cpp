#include "canon/review/review.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "canon/frames/facing.h"
#include "canon/splits/leaks.h"
#include "canon/values/subset.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr std::pair<const char*, Verdict> kVerdicts[] = {{"undecided", Verdict::kUndecided},
                                                         {"keep", Verdict::kKeep},
                                                         {"drop", Verdict::kDrop},
                                                         {"relabel", Verdict::kRelabel},
                                                         {"cut", Verdict::kCut}};

constexpr std::size_t kMostShown = 50;
constexpr std::size_t kMostOfClip = 1000;  // each is compared with the others of its clip

std::string VerdictName(Verdict verdict) {
  return std::find_if(std::begin(kVerdicts), std::end(kVerdicts),
                      [&](const auto& one) { return one.second == verdict; })
      ->first;
}

/// Error of a single decision; empty: valid.
std::string Incomplete(const Decision& decision) {
  if (decision.verdict == Verdict::kUndecided) return "decision is missing: keep, drop, relabel or cut";
  const bool of_set = decision.verdict == Verdict::kKeep && !decision.finding.empty();
  if (decision.clip.empty() && !of_set) return "no clip is named";
  if (decision.verdict == Verdict::kKeep && decision.finding.empty()) return "keep needs the code of a finding";
  const bool fingerprint =
      decision.content.size() == 16 && decision.content.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!decision.content.empty() && !fingerprint) {
    return "content '" + decision.content + "' is not a fingerprint of 16 hexadecimal digits";
  }
  if (decision.verdict == Verdict::kCut && decision.end == 0)
    return "cut needs end: the frame after the last that stays";
  if (decision.verdict != Verdict::kRelabel && !decision.label.empty()) return "label is for relabel only";
  if (decision.verdict == Verdict::kRelabel && decision.label.empty()) return "relabel needs a label";
  if (decision.verdict != Verdict::kCut && (decision.begin != 0 || decision.end != 0))
    return "begin and end are for cut only";
  if (decision.verdict == Verdict::kCut && decision.end <= decision.begin) {
    return "cut needs frames: end " + std::to_string(decision.end) + " is not beyond begin " +
           std::to_string(decision.begin);
  }
  return "";
}

/// Why two decisions about one clip contradict each other; empty: they do not.
std::string Contradiction(const Decision& a, const Decision& b) {
  if (!a.content.empty() && !b.content.empty() && a.content != b.content) {
    return "two motions, " + a.content + " and " + b.content;
  }
  const auto is = [&](Verdict one, Verdict other) {
    return (a.verdict == one && b.verdict == other) || (a.verdict == other && b.verdict == one);
  };
  const bool keeps = a.verdict == Verdict::kKeep || b.verdict == Verdict::kKeep;
  const bool one_pair = a.other.empty() || b.other.empty() || a.other == b.other;
  if (keeps && a.verdict != b.verdict && a.finding == b.finding && one_pair) {
    return VerdictName(a.verdict) + " and " + VerdictName(b.verdict);
  }
  if (is(Verdict::kDrop, Verdict::kRelabel)) return "drop and relabel";
  if (is(Verdict::kDrop, Verdict::kCut)) return "drop and cut";
  if (is(Verdict::kRelabel, Verdict::kRelabel) && a.label != b.label) return "'" + a.label + "' and '" + b.label + "'";
  if (is(Verdict::kCut, Verdict::kCut) && (a.begin != b.begin || a.end != b.end)) return "two cuts";
  return "";
}

Status Check(const Review& review, const std::filesystem::path& path) {
  std::string problems;
  std::size_t count = 0;
  bool contradicts = false;
  const auto add = [&](const std::string& problem) {
    if (++count <= kMostShown) problems += (problems.empty() ? "" : "\n") + problem;
  };
  std::map<std::string, std::vector<const Decision*>> of_clip;
  for (const Decision& decision : review.decisions) {
    if (count > kMostShown) break;
    if (const std::string why = Incomplete(decision); !why.empty()) add(decision.place + ": " + why);
    std::vector<const Decision*>& others = of_clip[decision.clip];
    if (others.size() == kMostOfClip) {
      return Fail(ErrorCode::kConfig,
                  "more than " + std::to_string(kMostOfClip) + " decisions about clip '" + decision.clip + "'",
                  decision.place, "keep one of those that repeat others");
    }
    for (const Decision* earlier : others) {
      const std::string why = Contradiction(*earlier, decision);
      if (!why.empty()) {
        contradicts = true;
        add(decision.place + ": clip '" + decision.clip + "' has another decision at " + earlier->place + ": " + why);
      }
    }
    others.push_back(&decision);
  }
  if (problems.empty()) return {};
  if (count > kMostShown) problems += "\nand more";
  return Fail(ErrorCode::kConfig, problems, DisplayPath(path),
              contradicts ? "keep one of the two contradicting decisions" : "docs/review.md lists the fields");
}

Finding About(const Clip& clip, const char* code, FindingAction action, const std::string& message,
              const Decision& decision) {
  return MakeFinding(code, Severity::kInfo, 0.0,
                     message + (decision.finding.empty() ? "" : " because of " + decision.finding) +
                         (decision.note.empty() ? "" : ": " + decision.note),
                     action, clip.id());
}

Finding Stale(const Decision& decision, const std::string& why) {
  return MakeFinding("review_stale", Severity::kWarning, 0.0,
                     decision.place + ": " + VerdictName(decision.verdict) + " was not applied: " + why,
                     FindingAction::kFlagged, decision.clip);
}

std::string ContentOf(const Clip& clip) { return clip.motion ? MotionFingerprint(*clip.motion) : ""; }

struct Row {
  Clip clip;
  ReviewedRow origin;
  bool dropped = false;
  std::vector<std::pair<std::int64_t, std::int64_t>> cuts;  ///< those applied
};

Status CarryOut(const Decision& decision, const Dataset& dataset, Row& row, AppliedReview& applied) {
  Clip& clip = row.clip;
  const std::pair<std::int64_t, std::int64_t> span(decision.begin, decision.end);
  const bool repeated_cut = std::find(row.cuts.begin(), row.cuts.end(), span) != row.cuts.end();
  if (row.dropped || (decision.verdict == Verdict::kCut && repeated_cut)) return {};
  if (decision.verdict == Verdict::kDrop) {
    applied.findings.push_back(About(clip, kReviewDrop, FindingAction::kDropped, "dropped by a review", decision));
    row.dropped = true;
  } else if (decision.verdict == Verdict::kRelabel) {
    if (dataset.LabelIndex(decision.label) < 0) {
      return Fail(ErrorCode::kConfig, "the dataset has no class '" + decision.label + "'", decision.place,
                  DidYouMean(decision.label, dataset.labels, "add it to assemble.classes"));
    }
    if (decision.label == clip.label) return {};
    applied.findings.push_back(About(clip, "review_relabel", FindingAction::kRepaired,
                                     "'" + clip.label + "' became '" + decision.label + "' by a review", decision));
    clip.label = decision.label;
    const int fine = dataset.FineLabelIndex(clip.fine_label);
    const bool fits =
        fine >= 0 && dataset.fine_labels[static_cast<std::size_t>(fine)].parent == dataset.LabelIndex(clip.label);
    if (!fits) clip.fine_label.clear();
  } else if (decision.verdict == Verdict::kCut) {
    const int frames = clip.motion->frame_count();
    if (decision.begin < 0 || decision.end > frames) {
      return Fail(ErrorCode::kConfig,
                  "frames " + std::to_string(decision.begin) + " to " + std::to_string(decision.end) +
                      " exceed the clip, which has " + std::to_string(frames),
                  decision.place, "boundaries can be moved inwards only; canon.trim moves them outwards");
    }
    if (decision.begin == 0 && decision.end == frames) return {};
    Finding done = About(
        clip, "review_cut", FindingAction::kRepaired,
        "cut to frames " + std::to_string(decision.begin) + " to " + std::to_string(decision.end) + " by a review",
        decision);
    auto cut = Cut(clip, static_cast<int>(decision.begin), static_cast<int>(decision.end));
    if (!cut) return Forward(cut);
    for (auto& [old_id, new_id] : applied.new_ids) {
      if (new_id == clip.id()) new_id = cut->id();
    }
    applied.new_ids[clip.id()] = cut->id();
    row.cuts.push_back(span);
    row.origin.end = row.origin.begin + static_cast<int>(decision.end);
    row.origin.begin += static_cast<int>(decision.begin);
    if (Status faced = FaceAgain(*cut); !faced) return faced;
    clip = std::move(*cut);
    done.clip = clip.id();
    applied.findings.push_back(std::move(done));
  }
  return {};
}

/// Stores the rows, sorted by id; rows of splits follow.
Status PutBack(std::vector<Row> rows, Dataset& dataset, AppliedReview& applied) {
  std::vector<std::size_t> order;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row].dropped) order.push_back(row);
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return rows[a].clip.id() < rows[b].clip.id(); });
  std::vector<int> new_row(rows.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    new_row[order[i]] = static_cast<int>(i);
    if (i > 0 && rows[order[i]].clip.id() == rows[order[i - 1]].clip.id()) {
      return Fail(ErrorCode::kInconsistent, "two cut clips have the same frames", rows[order[i]].clip.id(),
                  "drop one of them");
    }
    dataset.clips.push_back(std::move(rows[order[i]].clip));
    applied.origins.push_back(rows[order[i]].origin);
  }
  for (Row& row : rows) {
    if (row.dropped) applied.dropped.push_back(std::move(row.clip));
  }
  for (Split& split : dataset.splits) {
    MoveRows(new_row, split);
    for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) std::sort(part->begin(), part->end());
  }
  return {};
}

/// Findings follow the clips that were cut; findings of dropped clips are removed.
void MoveFindings(Dataset& dataset, const AppliedReview& applied) {
  std::set<std::string> dropped;
  for (const Clip& clip : applied.dropped) dropped.insert(clip.id());
  std::map<std::string, const ClipIdentity*> now;
  for (const Clip& clip : dataset.clips) now[clip.id()] = &clip.identity;
  std::vector<Finding> kept;
  for (Finding& finding : dataset.findings) {
    if (dropped.count(finding.clip) > 0) continue;
    const auto id = applied.new_ids.find(finding.clip);
    if (id != applied.new_ids.end() && now.count(id->second) > 0) {
      const ClipIdentity& identity = *now.at(id->second);
      const int frames = identity.end_frame - identity.begin_frame;
      const int moved = identity.begin_frame - FirstFrameOfId(finding.clip).value_or(0);
      if (finding.frame_end > finding.frame_begin) {
        finding.frame_begin = std::clamp(finding.frame_begin - moved, 0, frames);
        finding.frame_end = std::clamp(finding.frame_end - moved, 0, frames);
        if (finding.frame_end == finding.frame_begin) continue;  // its frames were cut away
      }
      finding.clip = id->second;
    }
    kept.push_back(std::move(finding));
  }
  dataset.findings = std::move(kept);
}

}  // namespace

void Decision::Declare(OptionVisitor& v) {
  v.Text("clip", clip, "id of the clip");
  v.Text("content", content, "fingerprint of its motion; a decision about another motion is not applied");
  v.Text("finding", finding, "code of the finding that it resolves");
  v.Text("other", other, "for a pair with the same motion, the other clip");
  v.Choice("decision", verdict, {std::begin(kVerdicts), std::end(kVerdicts)}, "what to do with the clip");
  v.Text("label", label, "relabel: its class");
  v.Integer("begin", begin, {0.0, 1e9}, "cut: first frame that stays");
  v.Integer("end", end, {0.0, 1e9}, "cut: the frame after the last that stays");
  v.Text("note", note, "free text");
}

void Review::Declare(OptionVisitor& v) {
  v.Text("dataset", dataset, "file that was reviewed");
  v.List("decisions", decisions, "decisions about clips");
}

Expected<Review> ReadReview(const std::filesystem::path& path) {
  const auto node = LoadData(path);
  if (!node) return Forward(node);
  auto review = OptionsFromConfig<Review>(*node);
  if (!review) return Forward(review);
  const ConfigNode* list = node->Find("decisions");
  for (std::size_t i = 0; i < review->decisions.size(); ++i) {
    const Origin& origin = list->sequence[i].origin;
    review->decisions[i].place = Origin{DisplayPath(path.filename()), origin.line, origin.column}.Text();
  }
  if (Status sound = Check(*review, path); !sound) return Forward(sound);
  return review;
}

std::string ReviewText(const Review& review) {
  std::string text =
      "dataset: " + YamlQuoted(review.dataset) + "\ndecisions:" + (review.decisions.empty() ? " []" : "") + "\n";
  for (const Decision& decision : review.decisions) {
    text += "  - clip: " + YamlQuoted(decision.clip) + "\n    content: " + YamlQuoted(decision.content) +
            "\n    finding: " + YamlQuoted(decision.finding) +
            (decision.other.empty() ? "" : "\n    other: " + YamlQuoted(decision.other)) +
            "\n    decision: " + VerdictName(decision.verdict) + "\n";
    if (decision.verdict == Verdict::kRelabel) text += "    label: " + YamlQuoted(decision.label) + "\n";
    if (decision.verdict == Verdict::kCut) {
      text += "    begin: " + std::to_string(decision.begin) + "\n    end: " + std::to_string(decision.end) + "\n";
    }
    if (!decision.note.empty()) text += "    note: " + YamlQuoted(decision.note) + "\n";
  }
  return text;
}

Expected<AppliedReview> ApplyReview(const Review& review, Dataset& dataset) {
  AppliedReview applied;
  std::map<std::string, std::size_t> row_of;
  std::map<std::string, std::string> content_of;
  std::vector<Row> rows;
  for (Clip& clip : dataset.clips) {
    row_of[clip.id()] = rows.size();
    const int frames = clip.motion ? clip.motion->frame_count() : 0;
    rows.push_back({std::move(clip), {rows.size(), 0, frames}, false, {}});
  }
  dataset.clips.clear();
  for (const Decision& decision : review.decisions) {
    if (decision.clip.empty()) continue;
    const auto row = row_of.find(decision.clip);
    if (row == row_of.end()) {
      applied.findings.push_back(Stale(decision, "the dataset has no such clip"));
      continue;
    }
    const Clip& clip = rows[row->second].clip;
    if (content_of.count(decision.clip) == 0) content_of[decision.clip] = ContentOf(clip);
    const std::string& content = content_of[decision.clip];  // before it is cut
    if (!decision.content.empty() && decision.content != content) {
      applied.findings.push_back(
          Stale(decision, "its motion has changed since, from " + decision.content + " to " + content));
      continue;
    }
    if (Status done = CarryOut(decision, dataset, rows[row->second], applied); !done) return Forward(done);
    if (row_of.emplace(clip.id(), row->second).second) content_of[clip.id()] = ContentOf(clip);
  }
  const auto stale = static_cast<std::size_t>(std::count_if(
      applied.findings.begin(), applied.findings.end(), [](const Finding& one) { return one.code == "review_stale"; }));
  if (stale > 0 && stale == review.decisions.size()) {
    return Fail(ErrorCode::kInconsistent,
                "none of the " + Counted(static_cast<long long>(stale), "decision") +
                    " matches a clip; the first: " + applied.findings.front().message,
                "review",
                "use the review of this dataset; this one is of another, or of motions that have all changed");
  }
  if (Status back = PutBack(std::move(rows), dataset, applied); !back) return Forward(back);
  MoveFindings(dataset, applied);
  return applied;
}

bool IsAccepted(const Review& review, const std::map<std::string, std::string>& contents, const std::string& clip,
                const std::string& other, const std::string& code) {
  const auto is = [&](const Decision& decision, const std::string& one, const std::string& two) {
    const auto content = contents.find(one);
    return decision.clip == one && (decision.other.empty() || decision.other == two) &&
           (decision.content.empty() || (content != contents.end() && decision.content == content->second));
  };
  const bool pair = !other.empty() && contents.count(other) > 0;
  return std::any_of(review.decisions.begin(), review.decisions.end(), [&](const Decision& decision) {
    return decision.verdict == Verdict::kKeep && decision.finding == code &&
           (is(decision, clip, other) || (pair && is(decision, other, clip)));
  });
}

}  // namespace mocurate
