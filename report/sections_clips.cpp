#include <algorithm>
#include <map>

#include "core/base/median.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/page.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostRows = 400;

std::string Change(const nlohmann::json& fitting, const char* key, int digits) {
  return NumberCell(Field(fitting, "before"), key, digits) + " → " + NumberCell(Field(fitting, "after"), key, digits);
}

/// Share of observations that the fit rejected as outliers; the residual excludes them.
std::string RejectedCell(const nlohmann::json& fitting) {
  const auto share = NumberOf(fitting, "rejected_share");
  return share ? PercentText(*share) : "–";
}

constexpr std::size_t kShownClips = 5;

long long KeptClips(const nlohmann::json& run) {
  long long count = 0;
  for (const nlohmann::json& clip : Elements(Field(run, "clips"))) count += Field(clip, "kept") == true ? 1 : 0;
  return count;
}

std::string Plural(long long count, const std::string& noun) {
  return CountText(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Evidence against the clips in the dataset; if there is any, the headline does not call the run sound.
struct Suspicion {
  long long clips = 0;          ///< with a finding of severity error, or a suspect fit
  double residual_mm = 0.0;     ///< largest RMS of their fits
  long long far_clips = 0;      ///< with a joint error above report.suspect_joint_error
  double joint_error_mm = 0.0;  ///< of the worst of these, or over all clips
  long long set_findings = 0;   ///< of severity error

  bool any() const { return clips > 0 || joint_error_mm > 0.0 || set_findings > 0; }
};

Suspicion SuspicionOf(const ReportInput& input) {
  Suspicion suspicion;
  const double most_mm = 1e3 * input.options.suspect_joint_error;
  for (const nlohmann::json& clip : Elements(Field(input.run, "clips"))) {
    if (Field(clip, "suspect") == true) {
      ++suspicion.clips;
      const double residual_mm = NumberOf(Field(clip, "fitting"), "residual_rms_mm").value_or(0.0);
      suspicion.residual_mm = std::max(suspicion.residual_mm, residual_mm);
    }
    const double error_mm = NumberOf(clip, "joint_error_mm").value_or(0.0);
    if (error_mm <= most_mm) continue;
    ++suspicion.far_clips;
    suspicion.joint_error_mm = std::max(suspicion.joint_error_mm, error_mm);
  }
  const double mean_mm = NumberOf(Field(input.run, "fit_error"), "joint_mm").value_or(0.0);
  if (mean_mm > most_mm) suspicion.joint_error_mm = std::max(suspicion.joint_error_mm, mean_mm);
  for (const nlohmann::json& finding : Elements(Field(input.run, "findings")))
    suspicion.set_findings += TextOf(finding, "severity") == "error" ? 1 : 0;
  return suspicion;
}

std::string SuspicionText(const Suspicion& suspicion, const ReportOptions& options) {
  std::string text;
  if (suspicion.joint_error_mm > 0.0) {
    text += "The fits are suspect: the mean joint error is " + FixedText(suspicion.joint_error_mm, 1) + " mm for " +
            (suspicion.far_clips > 0 ? "the worst of " + Plural(suspicion.far_clips, "clip") : "all clips") +
            ", above the " + FixedText(1e3 * options.suspect_joint_error, 0) +
            " mm of <code>report.suspect_joint_error</code>. ";
  }
  if (suspicion.clips > 0) {
    text +=
        Plural(suspicion.clips, "clip") + (suspicion.clips == 1 ? " is" : " are") +
        " suspect, by a finding of severity error or a suspect fit" +
        (suspicion.residual_mm > 0.0 ? " (residual up to " + FixedText(suspicion.residual_mm, 1) + " mm RMS)" : "") +
        ". ";
  }
  if (suspicion.set_findings > 0)
    text += Plural(suspicion.set_findings, "finding") + " of severity error about the set and its splits. ";
  return text;
}

std::string Verdict(const ReportInput& input, const Suspicion& suspicion) {
  const auto done = [&](long long clips) {
    return !suspicion.any() ? " went through" : clips == 1 ? " is in the dataset" : " are in the dataset";
  };
  const long long total = static_cast<long long>(Elements(Field(input.run, "clips")).size());
  const long long kept = KeptClips(input.run);
  std::string text = SuspicionText(suspicion, input.options);
  if (total == 0)
    text += "No clip was read.";
  else if (kept == 0)
    text += "None of the " + Plural(total, "clip") + " is in the dataset: see the reasons below.";
  else if (total == 1)
    text += std::string("The one clip") + done(1) + ".";
  else if (kept == total)
    text += "All " + Plural(total, "clip") + done(total) + ".";
  else
    text += CountText(kept) + " of " + Plural(total, "clip") + done(kept) + "; " + CountText(total - kept) +
            " excluded or refused.";
  if (const long long replaced = CountOf(input.run, "replaces_rotations"); replaced > 0)
    text += " The recorded rotations of " + Plural(replaced, "clip") +
            " are replaced by fitted ones; <code>fitting.method: none</code> keeps them.";
  const nlohmann::json& error = Field(input.run, "fit_error");
  const auto after = NumberOf(error, "joint_mm");
  const auto before = NumberOf(error, "evidence_mm");
  if (after && before && *before > 0.0) {
    text += " Error against truth " + FixedText(*before, 1) + " mm before and " + FixedText(*after, 1) +
            " mm after fitting.";
  } else if (after) {
    text += " Error against truth " + FixedText(*after, 1) + " mm.";
  }
  // The recogniser of the features, by the name of its item ("recogniser/1").
  const std::string extractor = TextOf(Field(input.run, "metrics"), "extractor");
  const nlohmann::json& recognisers = Field(Field(input.run, "metrics"), "recognisers");
  const nlohmann::json& named = Field(recognisers, extractor.substr(0, extractor.rfind('/')).c_str());
  const nlohmann::json none;
  const nlohmann::json& recogniser = named.is_object()                                 ? named
                                     : recognisers.is_object() && !recognisers.empty() ? *recognisers.begin()
                                                                                       : none;
  if (const auto mean = NumberOf(recogniser, "mean"))
    text += " The recogniser classifies " + PercentText(*mean) + " of the test clips correctly.";
  else if (const std::string why = TextOf(recogniser, "scored"); !why.empty())
    text += " The recogniser is not scored: " + EscapeHtml(why) + ".";
  return text;
}

/// The headline; its warnings are also attributes, for programs that read the page.
std::string VerdictHtml(const ReportInput& input) {
  const Suspicion suspicion = SuspicionOf(input);
  std::string attributes;
  const auto add = [&](const char* name, const std::string& value) {
    attributes += " data-" + std::string(name) + "=\"" + value + "\"";
  };
  if (suspicion.joint_error_mm > 0.0) add("joint-error-mm", FixedText(suspicion.joint_error_mm, 1));
  if (suspicion.clips > 0) add("suspect-clips", std::to_string(suspicion.clips));
  if (suspicion.set_findings > 0) add("set-errors", std::to_string(suspicion.set_findings));
  if (const long long replaced = CountOf(input.run, "replaces_rotations"); replaced > 0)
    add("replaces-rotations", std::to_string(replaced));
  return "<p class=\"verdict\"" + attributes + ">" + Verdict(input, suspicion) + "</p>\n";
}

std::string Tiles(const ReportInput& input) {
  const nlohmann::json& audit = Field(input.run, "audit");
  const long long total = static_cast<long long>(Elements(Field(input.run, "clips")).size());
  std::string html = "<dl class=\"tiles\">\n" +
                     Tile("Clips kept", CountText(KeptClips(input.run)), "of " + CountText(total) + " read");
  if (const auto seconds = NumberOf(audit, "seconds")) {
    html += Tile("Motion", FixedText(*seconds / 60.0, 1) + " min",
                 CountCell(audit, "frames") + " frames in " + Plural(CountOf(audit, "clips"), "clip"));
  }
  if (input.dataset && input.dataset->skeleton) {
    html += Tile("Skeleton", EscapeHtml(input.dataset->skeleton->name),
                 std::to_string(input.dataset->skeleton->joint_count()) + " joints, " +
                     (input.dataset->joints_only ? "positions only" : "with rotations"));
  }
  const std::vector<double> residuals = OverClips(input.run, "", "residual_rms_mm");
  if (!residuals.empty())
    html += Tile("Residual", FixedText(Quantile(residuals, 0.5), 1) + " mm", "median of the clips' RMS");
  return html + "</dl>\n";
}

/// A recording and the first frame that something is said about.
struct ListedClip {
  std::string item;
  std::string clip{};  ///< that the frame is of; empty: of the item
  int frame = 0;
};

/// First clips of a group, in the viewer where there is one, and the number of others.
std::string ClipList(const ReportInput& input, const std::vector<ListedClip>& clips) {
  std::string html;
  for (std::size_t i = 0; i < std::min(kShownClips, clips.size()); ++i)
    html += (i > 0 ? ", " : "") +
            ViewerLink(input, clips[i].clip.empty() ? clips[i].item : clips[i].clip, clips[i].frame, clips[i].item);
  if (clips.size() > kShownClips)
    html += " and " + CountText(static_cast<long long>(clips.size() - kShownClips)) + " more";
  return html;
}

struct Group {
  std::string message;
  std::vector<ListedClip> clips;
  long long count = 0;
  std::string severity;
  std::string action;
};

std::string ReasonsTable(const ReportInput& input) {
  const nlohmann::json& run = input.run;
  std::map<std::pair<std::string, std::string>, Group> groups;
  for (const nlohmann::json& clip : Elements(Field(run, "clips"))) {
    for (const char* how : {"failure", "excluded"}) {
      const nlohmann::json& reason = Field(clip, how);
      if (!reason.is_object()) continue;
      Group& group = groups[{TextOf(reason, "stage"), TextOf(reason, "code")}];
      if (group.clips.empty()) group.message = TextOf(reason, "message");
      group.severity = how == std::string("failure") ? "yes" : "no, a rule of the configuration";
      group.clips.push_back({TextOf(clip, "item")});
    }
  }
  if (groups.empty()) return Paragraph("No clip was excluded or refused.");
  HtmlTable table{"Reasons of excluded and refused clips",
                  {"Stage", "Reason", "Failure", "Clips", "First message", "Which"},
                  {},
                  false};
  for (const auto& [key, group] : groups) {
    table.rows.push_back({EscapeHtml(key.first), EscapeHtml(key.second), group.severity,
                          CountText(static_cast<long long>(group.clips.size())), EscapeHtml(group.message),
                          ClipList(input, group.clips)});
  }
  return table.Html();
}

/// Findings about the whole set: drawn persons, leaks, different rates.
std::string SetFindingsHtml(const nlohmann::json& run) {
  HtmlTable table{"Findings about the set and its splits", {"Finding", "Severity", "Message", "Action"}, {}, false};
  for (const nlohmann::json& finding : Elements(Field(run, "findings"))) {
    const std::string clip = TextOf(finding, "clip");
    table.rows.push_back({TextCell(finding, "code"), TextCell(finding, "severity"),
                          EscapeHtml((clip.empty() ? "" : clip + ": ") + TextOf(finding, "message")),
                          TextCell(finding, "action")});
  }
  return table.rows.empty() ? Paragraph("Nothing was found wrong or suspect about the set and its splits.")
                            : table.Html();
}

}  // namespace

std::string HeadHtml(const ReportInput& input) {
  std::string name = TextOf(input.run, "name");
  if (name.empty()) name = "run";
  std::string html = "<h1>" + EscapeHtml(name) + "</h1>\n";
  if (const std::string text = TextOf(input.run, "description"); !text.empty())
    html += Paragraph(EscapeHtml(text), "lead");
  return html + VerdictHtml(input) + Tiles(input);
}

std::string FunnelHtml(const ReportInput& input) {
  BarChart chart;
  chart.title = "Clips of each stage: done, suspect, excluded by rule, failed";
  const long long listed = static_cast<long long>(Elements(Field(input.run, "clips")).size());
  HtmlTable table{"", {"Stage", "Items", "Done", "Suspect", "Excluded by rule", "Refused", "Crashed"}};
  std::map<std::string, int> seen;
  for (const nlohmann::json& stage : Elements(Field(input.run, "stages"))) {
    const std::string name = TextOf(stage, "stage");
    const auto count = [&stage](const char* key) { return CountOf(stage, key); };
    const std::string branch = TextOf(stage, "branch");
    table.rows.push_back({EscapeHtml(branch.empty() ? name : name + " (" + branch + ")"), CountText(count("items")),
                          CountText(count("done")), CountText(count("suspect")), CountText(count("excluded")),
                          CountText(count("refused")), CountText(count("crashed"))});
    const bool per_clip = name == "ingest" || name == "fitting" || name == "canon";
    if (!per_clip || seen[name]++ > 0 || count("items") == 0) continue;
    const long long ruled = count("excluded");
    const long long lost = count("refused") + count("crashed");
    chart.rows.push_back({name,
                          {{static_cast<double>(count("done")), kGoodColour, "done"},
                           {static_cast<double>(count("suspect")), kSuspectColour, "suspect"},
                           {static_cast<double>(ruled), kBeforeColour, "excluded by rule"},
                           {static_cast<double>(lost), kBadColour, "failed"}},
                          std::to_string(count("items") - ruled - lost) + " of " + std::to_string(count("items"))});
  }
  chart.rows.push_back({"kept",
                        {{static_cast<double>(KeptClips(input.run)), kAfterColour, "kept"}},
                        std::to_string(KeptClips(input.run)) + " of " + std::to_string(listed)});
  std::string html = Paragraph("Results of " + Plural(listed, "clip") + " by stage.");
  chart.legend = {{0.0, kGoodColour, "done"},
                  {0.0, kSuspectColour, "suspect, but kept"},
                  {0.0, kBeforeColour, "excluded by a rule"},
                  {0.0, kBadColour, "failed"},
                  {0.0, kAfterColour, "in the dataset"}};
  html += ToInlineSvg(chart.Draw()) + ReasonsTable(input);
  return html + "<details><summary>All stages</summary>" + table.Html() + "</details>\n";
}

std::string DatasetHtml(const ReportInput& input) {
  const nlohmann::json& audit = Field(input.run, "audit");
  const nlohmann::json& labels = Field(audit, "per_label");
  if (!audit.is_object()) return Paragraph("The run ended before the audit of the dataset.");
  std::string html;
  HtmlTable splits{"Splits", {"Split", "Train", "Validation", "Test", "Rule", "Leak check"}, {}, false};
  for (const nlohmann::json& split : Elements(Field(audit, "splits"))) {
    const long long test = CountOf(split, "test");
    splits.rows.push_back({TextCell(split, "name"), CountCell(split, "train"), CountCell(split, "validation"),
                           test > 0 ? CountText(test) : std::string("0: no clip tests, nothing is scored"),
                           TextCell(split, "rule"), TextCell(split, "leak_check")});
  }
  html += splits.rows.empty() ? Paragraph("The dataset has no split.") : splits.Html();
  html += SetFindingsHtml(input.run);
  BarChart chart;
  chart.title = "Clips per label";
  if (labels.is_object()) {
    for (const auto& [label, count] : labels.items()) {
      const double value = count.is_number() ? count.get<double>() : 0.0;
      chart.rows.push_back({label.empty() ? "(none)" : label, {{value, kAfterColour, "clips"}}, FixedText(value, 0)});
    }
  }
  if (chart.rows.empty()) return html;
  return html + "<details" + (chart.rows.size() <= 12 ? " open" : "") + "><summary>Clips per label (" +
         std::to_string(chart.rows.size()) + ")</summary>" + ToInlineSvg(chart.Draw()) + "</details>\n";
}

std::string FindingsHtml(const ReportInput& input) {
  std::map<std::string, Group> groups;
  for (const nlohmann::json& clip : Elements(Field(input.run, "clips"))) {
    for (const nlohmann::json& finding : Elements(Field(clip, "findings"))) {
      Group& group = groups[TextOf(finding, "code")];
      if (group.count++ == 0) {
        group.message = TextOf(finding, "message");
        group.severity = TextOf(finding, "severity");
        group.action = TextOf(finding, "action");
      }
      const std::string item = TextOf(clip, "item");
      if (group.clips.empty() || group.clips.back().item != item) {
        group.clips.push_back({item, TextOf(finding, "clip"), static_cast<int>(CountOf(finding, "frame_begin"))});
      }
    }
  }
  const bool set = !Elements(Field(input.run, "findings")).empty();
  const std::string elsewhere =
      set ? Paragraph(
                "Findings about the set and its splits are under <a href=\"#dataset\">Labels and "
                "splits</a>.")
          : "";
  if (groups.empty()) return Paragraph("Nothing was found wrong or suspect about any clip.") + elsewhere;
  HtmlTable table{"", {"Finding", "Severity", "Times", "Clips", "Action", "First message", "Which"}, {}, false};
  for (const auto& [code, group] : groups) {
    table.rows.push_back({EscapeHtml(code), EscapeHtml(group.severity), CountText(group.count),
                          CountText(static_cast<long long>(group.clips.size())), EscapeHtml(group.action),
                          EscapeHtml(group.message), ClipList(input, group.clips)});
  }
  return table.Html() + elsewhere;
}

std::string ClipsHtml(const ReportInput& input) {
  const nlohmann::json& pages = Field(input.run, "pages");
  std::vector<const nlohmann::json*> clips;
  for (const nlohmann::json& clip : Elements(Field(input.run, "clips"))) {
    if (NumberOf(Field(clip, "fitting"), "residual_rms_mm")) clips.push_back(&clip);
  }
  if (clips.empty()) return Paragraph("No clip was fitted.");
  const auto has_page = [&pages](const nlohmann::json* clip) {
    return Field(pages, TextOf(*clip, "item").c_str()).is_object();
  };
  const auto residual = [](const nlohmann::json* clip) {
    return *NumberOf(Field(*clip, "fitting"), "residual_rms_mm");
  };
  std::stable_sort(clips.begin(), clips.end(), [&](const nlohmann::json* a, const nlohmann::json* b) {
    if (has_page(a) != has_page(b)) return has_page(a);
    return residual(a) > residual(b);
  });
  HtmlTable table{
      "Worst fits first, those with a page of their own on top; a head sorts",
      {"Clip", "Residual RMS, mm", "Rejected", "Bone length std, mm", "Jerk, m/s³", "Frames corrected", "Findings"}};
  for (const nlohmann::json* clip : clips) {
    if (table.rows.size() >= kMostRows) break;
    const std::string item = TextOf(*clip, "item");
    const nlohmann::json& fitting = Field(*clip, "fitting");
    std::string name = ViewerLink(input, item, 0, item);
    if (has_page(clip)) {
      const nlohmann::json& files = Field(pages, item.c_str());
      name = "<a href=\"" + TextCell(files, "page") + "\">" + EscapeHtml(item) + "</a>";
      if (Field(input.run, "viewers").contains("clips")) name += ", " + ViewerLink(input, item, 0, "3‑D");
      const std::string video = TextOf(files, "video");
      if (!video.empty()) name += ", <a href=\"" + EscapeHtml(video) + "\">video</a>";
    }
    table.rows.push_back({name, NumberCell(fitting, "residual_rms_mm", 1), RejectedCell(fitting),
                          Change(fitting, "bone_spread_mm", 1), Change(fitting, "jerk", 0),
                          CountText(CountOf(Field(fitting, "repairs"), "any_frames")),
                          CountText(static_cast<long long>(Elements(Field(*clip, "findings")).size()))});
  }
  const std::size_t left = clips.size() - table.rows.size();
  return table.Html() +
         (left > 0 ? Paragraph(CountText(static_cast<long long>(left)) + " more clips are in the dataset.", "soft")
                   : "");
}

}  // namespace mocurate
