#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/text.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/page.h"
#include "report/page_files.h"
#include "report/run_facts.h"

namespace mocurate {
namespace {

constexpr int kMostPoints = 240;

/// A table {"title", "rows": [cells, the heading first], "notes"} of texts; empty where it is null.
std::string HtmlOfTexts(const nlohmann::json& texts) {
  if (!texts.is_object()) return "";
  HtmlTable table{TextCell(texts, "title"), {}};
  for (const nlohmann::json& row : Elements(Field(texts, "rows"))) {
    std::vector<std::string> cells;
    for (const nlohmann::json& cell : row) cells.push_back(EscapeHtml(cell.get<std::string>()));
    table.rows.push_back(std::move(cells));
  }
  table.head = table.rows.front();
  table.rows.erase(table.rows.begin());
  std::string html = table.Html();
  for (const nlohmann::json& note : Elements(Field(texts, "notes"))) {
    html += Paragraph(EscapeHtml(note.get<std::string>()), "soft");
  }
  return html;
}

std::string ConfusionTable(const nlohmann::json& scored) {
  const std::vector<nlohmann::json>& matrix = Elements(Field(scored, "confusion"));
  const std::vector<nlohmann::json>& labels = Elements(Field(scored, "labels"));
  if (matrix.empty() || matrix.size() != labels.size()) return "";
  std::string html =
      "<div class=\"scroll\"><table class=\"heat\"><caption>Rows: true class. Columns: predicted class "
      "(numbers as in the "
      "rows). Counts over all seeds; darker cells have a larger share of the row.</caption><thead><tr><th "
      "scope=\"col\">Label</th>";
  for (std::size_t c = 0; c < labels.size(); ++c) html += "<th scope=\"col\">" + std::to_string(c + 1) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (std::size_t r = 0; r < matrix.size(); ++r) {
    const std::string name = labels[r].is_string() ? labels[r].get<std::string>() : "";
    html += "<tr><th scope=\"row\">" + std::to_string(r + 1) + " " + EscapeHtml(name) + "</th>";
    const std::vector<double> row = NumbersOf(matrix[r]);
    double sum = 0.0;
    for (const double value : row) sum += value;
    for (const double value : row) {
      const double share = sum > 0.0 ? value / sum : 0.0;
      if (!(value > 0.0))
        html += "<td></td>";
      else
        html += "<td" + std::string(share > 0.5 ? " class=\"hot\"" : "") + " style=\"background:rgba(var(--heat)," +
                FixedText(0.08 + 0.92 * share, 2) + ")\">" + FixedText(value, 0) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// Means over blocks, so that a chart has at most kMostPoints; NaN is skipped. `x` may be empty: 1, 2, 3, ...
std::vector<PlotPoint> Thinned(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<PlotPoint> points;
  const std::size_t count = x.empty() ? y.size() : std::min(x.size(), y.size());
  const std::size_t block = std::max<std::size_t>(1, (count + kMostPoints - 1) / kMostPoints);
  for (std::size_t begin = 0; begin < count; begin += block) {
    double sum_x = 0.0, sum_y = 0.0, used = 0.0;
    for (std::size_t i = begin; i < std::min(count, begin + block); ++i) {
      if (!std::isfinite(y[i])) continue;
      sum_x += x.empty() ? static_cast<double>(i + 1) : x[i];
      sum_y += y[i];
      used += 1.0;
    }
    if (used > 0.0) points.push_back({sum_x / used, sum_y / used});
  }
  return points;
}

/// Summaries of the training stages by item ("recogniser/1", "Action2Motion").
std::map<std::string, const nlohmann::json*> Trainings(const nlohmann::json& run) {
  std::map<std::string, const nlohmann::json*> trainings;
  const nlohmann::json& listed = Field(run, "training");
  if (listed.is_object()) {
    for (const auto& [item, summary] : listed.items()) trainings[item] = &summary;
  }
  return trainings;
}

bool IsRecogniser(const nlohmann::json& training) { return Field(training, "epochs").is_number(); }

/// " (250 iterations, batches of 64 clips)" of a group of trainings; values that differ between them or are unknown are
/// omitted.
std::string LengthText(const std::vector<std::pair<std::string, const nlohmann::json*>>& trainings) {
  std::string text;
  const auto add = [&](const char* key, const char* before, const char* noun) {
    const auto count = NumberOf(*trainings.front().second, key);
    const bool alike = std::all_of(trainings.begin(), trainings.end(),
                                   [&](const auto& training) { return NumberOf(*training.second, key) == count; });
    if (!count || !alike) return;
    text += (text.empty() ? " (" : ", ") + (before + Counted(static_cast<long long>(*count), noun));
  };
  add("epochs", "", "epoch");
  add("iterations", "", "iteration");
  add("batch", "batches of ", "clip");
  return text.empty() ? text : text + ")";
}

std::string GeneratorCharts(const std::string& item, const nlohmann::json& training) {
  const nlohmann::json& history = Field(training, "history");
  Plot loss{item + ": loss" + LengthText({{item, &training}}), "iteration", "loss", {}};
  Plot kl{item + ": Kullback-Leibler term", "iteration", "KL", {}};
  const std::vector<double> steps = NumbersOf(Field(history, "step"));
  for (const auto& [column, values] : history.items()) {
    if (column == "step") continue;
    Plot& chart = column == "kl" ? kl : loss;
    chart.curves.push_back({column, Thinned(steps, NumbersOf(values))});
  }
  return PlotHtml(loss) + PlotHtml(kl);
}

std::string RecogniserCharts(const std::string& kind,
                             const std::vector<std::pair<std::string, const nlohmann::json*>>& seeds) {
  Plot loss{kind + ": training loss by seed" + LengthText(seeds), "step", "loss", {}};
  Plot accuracy{kind + ": accuracy on the validation fold by seed", "step", "accuracy", {}};
  for (const auto& [item, training] : seeds) {
    const nlohmann::json& history = Field(*training, "history");
    const std::vector<double> values = NumbersOf(Field(history, "loss")), steps = NumbersOf(Field(history, "step"));
    const std::vector<double> checked = NumbersOf(Field(history, "validation_accuracy")),
                              checks = NumbersOf(Field(history, "check_step"));
    // The last check ends the training without the validation part; that on all clips begins anew.
    const bool anew = Field(*training, "refit") == true && !checks.empty() && steps.size() == values.size();
    const auto end = anew ? std::upper_bound(steps.begin(), steps.end(), checks.back()) : steps.end();
    const auto first = static_cast<std::ptrdiff_t>(end - steps.begin());
    if (!values.empty()) {
      loss.curves.push_back({"seed " + item, Thinned({steps.begin(), end}, {values.begin(), values.begin() + first})});
    }
    if (end != steps.end()) {
      loss.curves.push_back({"seed " + item + ", begun anew on all clips",
                             Thinned({end, steps.end()}, {values.begin() + first, values.end()})});
    }
    if (!checked.empty()) accuracy.curves.push_back({"seed " + item, Thinned(checks, checked)});
  }
  return PlotHtml(loss) + PlotHtml(accuracy);
}

/// Networks that the run did not train, with the reason; empty when there are none.
std::string UntrainedHtml(const nlohmann::json& run) {
  HtmlTable table{"Not trained", {"Item", "Reason", "Message"}, {}, false};
  const nlohmann::json& untrained = Field(run, "untrained");
  if (!untrained.is_object()) return "";
  for (const auto& [item, error] : untrained.items()) {
    table.rows.push_back({EscapeHtml(item), TextCell(error, "code"), TextCell(error, "message")});
  }
  return table.rows.empty() ? "" : table.Html();
}

}  // namespace

std::string GeneratedHtml(const ReportInput& input) {
  std::string html;
  for (const auto& [network, reason] : Field(input.run, "ungenerated").items()) {
    html += Paragraph(EscapeHtml(network) + " generated no motions: " + EscapeHtml(reason.get<std::string>()), "soft");
  }
  const nlohmann::json& viewers = Field(input.run, "viewers");
  const std::string viewer = TextCell(viewers, "generated"), failed = TextCell(Field(viewers, "failed"), "generated");
  if (!failed.empty()) html += Paragraph("Their page could not be written: " + failed, "soft");
  if (viewer.empty() && html.empty()) {
    return Paragraph(input.options.viewer ? "No network of this run generated motions."
                                          : "<code>report.viewer: false</code> leaves out generated motions.");
  }
  if (viewer.empty()) return html;
  return html +
         Paragraph(
             "Up to three motions of each class by each network, its first seed, beside real ones. They are not "
             "selected. <a href=\"" +
             viewer + "\">In a page of their own</a>.") +
         "<iframe src=\"" + viewer + "\" title=\"Generated motions beside real ones\" loading=\"lazy\"></iframe>\n";
}

std::string TableHtml(const ReportInput& input) {
  const std::string table = HtmlOfTexts(Field(input.run, "table"));
  if (!table.empty()) return table;
  if (Field(input.run, "recognition").is_object()) {
    return Paragraph("Only recognisers were scored: their table is under Recognition.");
  }
  const nlohmann::json& failed = Field(input.run, "unevaluated");
  if (failed.is_object()) {
    return Paragraph("There is no table: the evaluation failed. " + TextCell(failed, "message"));
  }
  return Paragraph("The run ended before the evaluation, or trained nothing to evaluate.");
}

std::string RecognisersHtml(const ReportInput& input) {
  const nlohmann::json& metrics = Field(input.run, "metrics");
  HtmlTable table{"Share of correctly recognised test clips", {"Recogniser", "Mean", "By seed", "Test clips"}};
  const nlohmann::json& recognisers = Field(metrics, "recognisers");
  for (const auto& [name, scored] : recognisers.items()) {
    const auto mean = NumberOf(scored, "mean");
    if (!mean) {
      const std::string why = TextOf(scored, "scored");
      if (!why.empty()) table.rows.push_back({EscapeHtml(name), "not scored: " + EscapeHtml(why), "–", "0"});
      continue;
    }
    std::string seeds;
    for (const double accuracy : NumbersOf(Field(scored, "test_accuracy")))
      seeds += (seeds.empty() ? "" : ", ") + FixedText(accuracy, 3);
    table.rows.push_back({EscapeHtml(name), FixedText(*mean, 3), seeds, CountCell(scored, "test_clips")});
  }
  nlohmann::json nearest = Field(metrics, "nearest_neighbour");
  if (!nearest.is_object()) nearest = Field(Field(input.run, "audit"), "nearest_neighbour");
  if (const auto accuracy = NumberOf(nearest, "accuracy")) {
    const bool scored = NumberOf(nearest, "count").value_or(0.0) > 0.0;
    table.rows.push_back({"Nearest neighbour, without training", scored ? FixedText(*accuracy, 3) : "not scored", "–",
                          CountCell(nearest, "count")});
  }
  if (table.rows.empty()) return Paragraph("No recogniser was scored in this run.");
  std::string html = table.Html() + HtmlOfTexts(Field(input.run, "recognition"));
  for (const auto& [name, scored] : recognisers.items()) {
    const std::string confusion = ConfusionTable(scored);
    if (confusion.empty()) continue;
    html += "<h3>Confusion of " + EscapeHtml(name) + " on the test clips</h3>\n" + confusion;
    break;
  }
  return html;
}

std::string CurvesHtml(const ReportInput& input) {
  std::map<std::string, std::vector<std::pair<std::string, const nlohmann::json*>>> recognisers;
  std::string charts;
  for (const auto& [item, training] : Trainings(input.run)) {
    const nlohmann::json& history = Field(*training, "history");
    if (!history.is_object()) continue;
    if (!IsRecogniser(*training))
      charts += GeneratorCharts(item, *training);
    else
      recognisers[item.substr(0, item.find('/'))].emplace_back(item.substr(item.find('/') + 1), training);
  }
  for (const auto& [kind, seeds] : recognisers) charts += RecogniserCharts(kind, seeds);
  if (const auto learning = LearningSheet(Field(Field(input.run, "metrics"), "rows"), "")) {
    std::string scores;
    for (const Plot& plot : learning->plots) scores += PlotHtml(plot);
    charts = scores + charts;
  }
  if (charts.empty()) return Paragraph("No training of this run has a history.");
  return "<div class=\"charts wide\">\n" + charts + "</div>\n";
}

std::string StopsHtml(const ReportInput& input) {
  HtmlTable generators{"Generators",
                       {"Item", "Iterations", "Batch", "Training clips", "Passes over the clips", "Last loss"}};
  HtmlTable recognisers{
      "Recognisers",
      {"Item", "Epochs", "Batch", "Chosen epoch", "Validation accuracy", "Last training accuracy", "Chosen by"},
      {},
      false};
  for (const auto& [item, training] : Trainings(input.run)) {
    if (IsRecogniser(*training)) {
      recognisers.rows.push_back({EscapeHtml(item), NumberCell(*training, "epochs", 0),
                                  NumberCell(*training, "batch", 0), NumberCell(*training, "chosen_epoch", 0),
                                  NumberCell(*training, "validation_accuracy", 3),
                                  NumberCell(*training, "train_accuracy", 3), TextCell(*training, "validation_rule")});
      continue;
    }
    const auto clips = NumberOf(*training, "clips");
    const double passes = NumberOf(*training, "iterations").value_or(0.0) * NumberOf(*training, "batch").value_or(0.0);
    generators.rows.push_back({EscapeHtml(item), CountCell(*training, "iterations"), NumberCell(*training, "batch", 0),
                               NumberCell(*training, "clips", 0),
                               clips && *clips > 0.0 ? FixedText(passes / *clips, 1) : "–",
                               NumberCell(*training, "loss", 4)});
  }
  const std::string failed = UntrainedHtml(input.run);
  if (generators.rows.empty() && recognisers.rows.empty())
    return failed.empty() ? Paragraph("Nothing was trained in this run.") : failed;
  std::string html =
      failed +
      Paragraph(
          "Training ends after the number of steps that the configuration states, not when it has converged. A "
          "generator "
          "stopped early scores worse than a published one: read the table with this in mind. <code>--budget N</code> "
          "trains N "
          "times as long.");
  if (!generators.rows.empty()) html += generators.Html();
  if (!recognisers.rows.empty()) html += recognisers.Html();
  return html;
}

std::string ReadingHtml(const ReportInput&) { return std::string(PageFile("reading.html")); }

}  // namespace mocurate
