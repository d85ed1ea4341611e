#include "canon/review/review.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/motion/fingerprint.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr std::pair<const char*, Verdict> kVerdicts[] = {
    {"keep", Verdict::kKeep}, {"drop", Verdict::kDrop}, {"relabel", Verdict::kRelabel}, {"cut", Verdict::kCut}};

std::string VerdictName(Verdict verdict) { return kVerdicts[static_cast<int>(verdict)].first; }

/// What is wrong with one decision by itself; empty: nothing.
std::string Incomplete(const Decision& decision) {
  if (decision.clip.empty()) return "no clip is named";
  if (decision.verdict == Verdict::kRelabel && decision.label.empty()) return "relabel wants a label";
  if (decision.verdict == Verdict::kCut && decision.end <= decision.begin) {
    return "cut wants frames: end " + std::to_string(decision.end) + " is not beyond begin " +
           std::to_string(decision.begin);
  }
  return "";
}

/// Why two decisions about one clip cannot both hold; empty: they can.
std::string Contradiction(const Decision& a, const Decision& b) {
  if (!a.content.empty() && !b.content.empty() && a.content != b.content) {
    return "two motions, " + a.content + " and " + b.content;
  }
  const auto is = [&](Verdict one, Verdict other) {
    return (a.verdict == one && b.verdict == other) || (a.verdict == other && b.verdict == one);
  };
  const bool keeps = a.verdict == Verdict::kKeep || b.verdict == Verdict::kKeep;
  if (keeps && a.verdict != b.verdict && a.finding == b.finding) {
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
  const auto add = [&problems](const std::string& problem) { problems += (problems.empty() ? "" : "\n") + problem; };
  std::map<std::string, std::vector<const Decision*>> of_clip;
  for (const Decision& decision : review.decisions) {
    if (const std::string why = Incomplete(decision); !why.empty()) add(decision.place + ": " + why);
    for (const Decision* earlier : of_clip[decision.clip]) {
      const std::string why = Contradiction(*earlier, decision);
      if (!why.empty()) {
        add(decision.place + ": clip '" + decision.clip + "' is decided otherwise at " + earlier->place + ": " + why);
      }
    }
    of_clip[decision.clip].push_back(&decision);
  }
  if (problems.empty()) return {};
  return Fail(ErrorCode::kConfig, problems, DisplayPath(path), "leave one of two decisions that contradict each other");
}

Finding About(const Clip& clip, const char* code, const char* action, const std::string& message,
              const Decision& decision) {
  Finding finding;
  finding.clip = clip.id();
  finding.code = code;
  finding.severity = Severity::kInfo;
  finding.message = message + (decision.finding.empty() ? "" : " because of " + decision.finding) +
                    (decision.note.empty() ? "" : ": " + decision.note);
  finding.action = action;
  return finding;
}

Finding Stale(const Decision& decision, const std::string& why) {
  Finding finding;
  finding.clip = decision.clip;
  finding.code = "review_stale";
  finding.message = decision.place + ": " + VerdictName(decision.verdict) + " was not carried out: " + why;
  finding.action = "flagged";
  return finding;
}

std::string ContentOf(const Clip& clip) { return clip.motion ? MotionFingerprint(*clip.motion) : ""; }

struct Row {
  Clip clip;
  bool dropped = false;
};

Status CarryOut(const Decision& decision, const Dataset& dataset, Row& row, AppliedReview& applied) {
  Clip& clip = row.clip;
  if (decision.verdict == Verdict::kDrop) {
    applied.findings.push_back(About(clip, kReviewDrop, "dropped", "dropped by a review", decision));
    row.dropped = true;
  } else if (decision.verdict == Verdict::kRelabel) {
    if (dataset.LabelIndex(decision.label) < 0) {
      const auto near = Nearest(decision.label, dataset.labels);
      return Fail(ErrorCode::kConfig, "the dataset has no class '" + decision.label + "'", decision.place,
                  near ? "did you mean '" + *near + "'?" : "add it to assemble.classes");
    }
    if (decision.label == clip.label) return {};
    applied.findings.push_back(About(clip, "review_relabel", "relabelled",
                                     "'" + clip.label + "' became '" + decision.label + "' by a review", decision));
    clip.label = decision.label;
    const int fine = dataset.FineLabelIndex(clip.fine_label);
    const bool fits =
        fine >= 0 &&
        dataset.labels[static_cast<std::size_t>(dataset.fine_labels[static_cast<std::size_t>(fine)].parent)] ==
            clip.label;
    if (!fits) clip.fine_label.clear();
  } else if (decision.verdict == Verdict::kCut) {
    const int frames = clip.motion->frame_count();
    if (decision.begin < 0 || decision.end > frames) {
      return Fail(ErrorCode::kConfig,
                  "frames " + std::to_string(decision.begin) + " to " + std::to_string(decision.end) +
                      " are not all of the clip, which has " + std::to_string(frames),
                  decision.place, "boundaries can be moved inwards only; canon.trim moves them outwards");
    }
    if (decision.begin == 0 && decision.end == frames) return {};
    Finding done = About(
        clip, "review_cut", "cut",
        "cut to frames " + std::to_string(decision.begin) + " to " + std::to_string(decision.end) + " by a review",
        decision);
    auto cut = Cut(clip, static_cast<int>(decision.begin), static_cast<int>(decision.end));
    if (!cut) return Forward(cut);
    applied.new_ids[clip.id()] = cut->id();
    clip = std::move(*cut);
    done.clip = clip.id();
    applied.findings.push_back(std::move(done));
  }
  return {};
}

/// Puts the rows back, sorted by id; rows of splits follow.
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
      return Fail(ErrorCode::kInconsistent, "two clips become one by their cuts", rows[order[i]].clip.id(),
                  "drop one of them");
    }
    dataset.clips.push_back(std::move(rows[order[i]].clip));
  }
  for (Row& row : rows) {
    if (row.dropped) applied.dropped.push_back(std::move(row.clip));
  }
  for (Split& split : dataset.splits) {
    for (std::vector<int>* part : {&split.train, &split.validation, &split.test}) {
      std::vector<int> kept;
      for (const int row : *part) {
        if (new_row[static_cast<std::size_t>(row)] >= 0) kept.push_back(new_row[static_cast<std::size_t>(row)]);
      }
      std::sort(kept.begin(), kept.end());
      *part = std::move(kept);
    }
  }
  return {};
}

}  // namespace

void Decision::Declare(OptionVisitor& v) {
  v.Text("clip", clip, "id of the clip");
  v.Text("content", content, "fingerprint of its motion; a decision about another motion is not carried out");
  v.Text("finding", finding, "code of the finding that it answers");
  v.Choice("decision", verdict, {std::begin(kVerdicts), std::end(kVerdicts)}, "what is to be done with the clip");
  v.Text("label", label, "relabel: its class");
  v.Integer("begin", begin, {0.0, 1e9}, "cut: first frame that stays");
  v.Integer("end", end, {0.0, 1e9}, "cut: the frame after the last that stays");
  v.Text("note", note, "for whoever reads it");
}

void Review::Declare(OptionVisitor& v) {
  v.Text("dataset", dataset, "file that was looked at");
  v.List("decisions", decisions, "about clips");
}

Expected<Review> ReadReview(const std::filesystem::path& path) {
  const auto node = LoadConfig(path);
  if (!node) return Forward(node);
  auto review = OptionsFromConfig<Review>(*node);
  if (!review) return Forward(review);
  const ConfigNode* list = node->Find("decisions");
  for (std::size_t i = 0; i < review->decisions.size(); ++i) {
    review->decisions[i].place = list->sequence[i].origin.Text();
  }
  if (Status sound = Check(*review, path); !sound) return Forward(sound);
  return review;
}

std::string ReviewText(const Review& review) {
  const auto quoted = [](const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  std::string text =
      "dataset: " + quoted(review.dataset) + "\ndecisions:" + (review.decisions.empty() ? " []" : "") + "\n";
  for (const Decision& decision : review.decisions) {
    text += "  - clip: " + quoted(decision.clip) + "\n    content: " + quoted(decision.content) +
            "\n    finding: " + quoted(decision.finding) + "\n    decision: " + VerdictName(decision.verdict) + "\n";
    if (decision.verdict == Verdict::kRelabel) text += "    label: " + quoted(decision.label) + "\n";
    if (decision.verdict == Verdict::kCut) {
      text += "    begin: " + std::to_string(decision.begin) + "\n    end: " + std::to_string(decision.end) + "\n";
    }
    if (!decision.note.empty()) text += "    note: " + quoted(decision.note) + "\n";
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
    rows.push_back({std::move(clip), false});
  }
  dataset.clips.clear();
  for (const Decision& decision : review.decisions) {
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
  if (Status back = PutBack(std::move(rows), dataset, applied); !back) return Forward(back);
  for (Finding& finding : dataset.findings) {
    if (const auto id = applied.new_ids.find(finding.clip); id != applied.new_ids.end()) finding.clip = id->second;
  }
  return applied;
}

bool IsAccepted(const Review& review, const std::string& clip, const std::string& content, const std::string& code) {
  return std::any_of(review.decisions.begin(), review.decisions.end(), [&](const Decision& decision) {
    return decision.verdict == Verdict::kKeep && decision.clip == clip && decision.finding == code &&
           (decision.content.empty() || decision.content == content);
  });
}

}  // namespace mocurate
