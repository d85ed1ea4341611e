#include "job/verbs/reproduce.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "report/options.h"
#include "report/stages.h"
#include "train/items.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRealRow = "Real";

/// A row of the options: a network with its partner networks, or the dataset.
struct DrawnRow {
  std::string name;
  fs::path checkpoint, first, fill;
  bool align = false;
  bool real = false;
};

class PictureMaker {
 public:
  PictureMaker(const JobOptions& options, const ReproducedRun& run) : options_(options), run_(run), own_(run.common) {
    own_.json = false;
    own_.quiet = true;
  }

  Expected<PaperPictures> Make() {
    for (const DrawnMotionsOptions& picture : options_.reproduce.pictures) {
      if (Status drawn = Draw(picture); !drawn) return Forward(drawn);
    }
    if (!options_.reproduce.curve.empty()) {
      if (Status drawn = DrawCurves(); !drawn) return Forward(drawn);
    }
    for (const std::string& kind : options_.reproduce.surveys) {
      if (Status made = MakeSurvey(kind); !made) return Forward(made);
    }
    return std::move(made_);
  }

 private:
  /// Whether an error ends everything, rather than one picture.
  static bool Ends(const Error& error) {
    return error.code == ErrorCode::kInterrupted || error.code == ErrorCode::kCannotWrite;
  }

  void Lose(const std::string& what, const std::string& why) {
    LogWarning(what + " is missing: " + why);
    made_.lost.push_back(what);
  }

  const DataSetOptions& SetOf(const DrawnMotionsOptions& picture) const {
    const auto found = std::find_if(options_.data.begin(), options_.data.end(),
                                    [&](const DataSetOptions& set) { return set.name == picture.set; });
    return found == options_.data.end() ? options_.data.front() : *found;
  }

  /// Whether an output is of an earlier run.
  bool Earlier(const fs::path& file) const {
    return IsStale(run_.stale, DisplayPath(file.lexically_relative(run_.folder)));
  }

  /// Empty where it was not trained.
  fs::path CheckpointOf(const std::string& network, const fs::path& folder) const {
    for (const NetworkOptions& one : options_.train.networks) {
      if (one.name != network) continue;
      const fs::path file = folder / "checkpoints" / (FileNameOf(one.name + "/" + std::to_string(one.seed())) + ".h5");
      std::error_code unknown;
      const bool trained = fs::is_regular_file(file, unknown) && !Earlier(file);
      return trained ? file : fs::path();
    }
    return {};
  }

  std::optional<DrawnRow> RowOf(const std::string& name, const fs::path& folder) const {
    if (name == kRealRow) return DrawnRow{name, {}, {}, {}, false, true};
    DrawnRow row{name, CheckpointOf(name, folder), {}, {}, false, false};
    for (const ScriptRowOptions& asked : options_.evaluate.rows) {
      if (asked.name != name) continue;
      row.checkpoint = CheckpointOf(asked.network, folder);
      if (!asked.first.empty()) row.first = CheckpointOf(asked.first, folder);
      if (!asked.fill.empty()) row.fill = CheckpointOf(asked.fill, folder);
      row.align = asked.align;
      if ((!asked.first.empty() && row.first.empty()) || (!asked.fill.empty() && row.fill.empty())) row.checkpoint = "";
    }
    if (row.checkpoint.empty()) return std::nullopt;
    return row;
  }

  /// The motions of a row as a file.
  Expected<fs::path> MotionsOf(const DrawnMotionsOptions& picture, const DrawnRow& row, const fs::path& folder) {
    const fs::path dataset = folder / "dataset.h5";
    if (row.real) return dataset;
    GenerateArguments asked;
    asked.checkpoint = row.checkpoint;
    asked.output = run_.folder / "motions" / (FileNameOf(picture.name + "_" + row.name) + ".h5");
    asked.force = true;
    asked.scripts = picture.scripts;
    if (!picture.scripts.empty()) asked.transition_frames = static_cast<int>(picture.transition_frames);
    asked.first = picture.scripts.empty() ? fs::path() : row.first;
    asked.fill = picture.scripts.empty() ? fs::path() : row.fill;
    asked.align = !picture.scripts.empty() && row.align;
    if (!picture.scripts.empty()) asked.count = static_cast<int>(picture.samples);
    if (!picture.scripts.empty() && row.first.empty() && Continues(row.checkpoint)) asked.previous = dataset;
    if (picture.denoise) {
      asked.denoise = dataset;
    } else if (picture.scripts.empty()) {
      asked.frames = picture.frames;
      asked.interpolate = static_cast<int>(picture.interpolate);
      for (const std::string& label : picture.labels) {
        asked.labels.push_back(label + ":" + std::to_string(picture.interpolate > 0 ? 1 : picture.samples));
      }
    }
    if (Status made = MakeFolder(asked.output.parent_path()); !made) return Forward(made);
    if (Status generated = GenerateVerb(own_, asked); !generated) return Forward(generated);
    return asked.output;
  }

  /// Whether a network only continues motions.
  bool Continues(const fs::path& checkpoint) const {
    const std::string name = checkpoint.stem().string();
    return std::any_of(options_.train.networks.begin(), options_.train.networks.end(), [&](const NetworkOptions& one) {
      return one.kind == NetworkKind::kMacvae && FileNameOf(one.name + "/" + std::to_string(one.seed())) == name;
    });
  }

  Status Draw(const DrawnMotionsOptions& picture) {
    const DataSetOptions& set = SetOf(picture);
    const fs::path folder = run_.folder / "data" / set.name;
    if (run_.sets.done.count(set.name) == 0) {
      Lose("picture '" + picture.name + "'", "set " + set.name + " failed");
      return {};
    }
    DrawArguments drawn;
    for (const std::string& name : picture.rows) {
      const std::string what = "picture '" + picture.name + "', row '" + name + "'";
      const auto row = RowOf(name, folder);
      if (!row) {
        Lose(what, "its network is not trained");
        continue;
      }
      const auto motions = MotionsOf(picture, *row, folder);
      if (!motions) {
        if (Ends(motions.error())) return Forward(motions);
        Lose(what, motions.error().Message());
        continue;
      }
      drawn.motions.push_back(row->name + "=" + motions->string());
    }
    if (drawn.motions.empty()) return {};
    if (motions_.empty()) motions_ = drawn.motions;
    if (picture.scripts.empty()) drawn.labels = picture.labels;
    drawn.samples = static_cast<int>(picture.interpolate > 0 ? picture.interpolate : picture.samples);
    drawn.stills = static_cast<int>(picture.stills);
    drawn.figure = "capsules";
    drawn.title = options_.reproduce.shows + " (" + set.name + (set.path.empty() ? ", substitute" : "") + ", profile " +
                  options_.profile + ")";
    drawn.force = true;
    for (const char* ending : {".svg", ".png"}) {
      drawn.output = run_.folder / "pictures" / (picture.name + ending);
      if (Status made = MakeFolder(drawn.output.parent_path()); !made) return made;
      if (Status done = DrawVerb(own_, drawn); !done) {
        if (Ends(done.error())) return done;
        Lose("picture '" + picture.name + "'", done.error().Message());
        return {};
      }
      made_.files.push_back(drawn.output);
    }
    return {};
  }

  /// Draws curves of rows "NAME, step 4" or "NAME, 40 frames", or of sets "uestc_50".
  Status DrawCurves() {
    static const std::pair<const char*, const char*> kPlotted[] = {
        {"accuracy", "Accuracy"},   {"accuracy_equivalent", "Accuracy, equivalent labels"},
        {"accuracy_top5", "Top-5"}, {"accuracy_denoised", "Accuracy, denoised"},
        {"FID_train", "FID train"}, {"FID_test", "FID test"},
        {"diversity", "Diversity"}, {"multimodality", "Multimodality"}};
    std::map<std::string, std::map<std::string, std::map<double, nlohmann::json>>> curves;  // metric, name, x
    for (const DataSetOptions& set : options_.data) {
      if (run_.sets.done.count(set.name) == 0) continue;
      for (const char* table : {"table.json", "recognition.json"}) {
        const fs::path file = run_.folder / "data" / set.name / "tables" / table;
        if (Earlier(file)) continue;
        const nlohmann::json json = ReadJson(file).value_or(nullptr);
        if (!json.is_object()) continue;
        for (const nlohmann::json& row : json.value("rows", nlohmann::json::array())) AddPoint(set.name, row, curves);
      }
    }
    nlohmann::json plots = nlohmann::json::array();
    for (const auto& [metric, title] : kPlotted) {
      nlohmann::json plot = {{"title", title + Origin()},
                             {"x_name", options_.reproduce.curve},
                             {"y_name", ""},
                             {"curves", nlohmann::json::array()}};
      for (const auto& [name, points] : curves[metric]) {
        nlohmann::json curve = {{"name", name}, {"points", nlohmann::json::array()}};
        for (const auto& [x, point] : points) curve["points"].push_back(point);
        if (points.size() > 1) plot["curves"].push_back(std::move(curve));
      }
      if (!plot["curves"].empty()) plots.push_back(std::move(plot));
    }
    if (plots.empty()) return {};
    auto stages = VerbStages::Make(own_);
    if (!stages) return Forward(stages);
    const fs::path numbers = run_.folder / "pictures/curves.json", picture = run_.folder / "pictures/curves.svg";
    if (Status made = MakeFolder(numbers.parent_path()); !made) return made;
    const nlohmann::json document = {{"plots", std::move(plots)}, {"columns", 3}};
    if (Status written = WriteFile(numbers, document.dump(1) + "\n"); !written) return written;
    const auto drawn =
        (*stages)->One(PlotDeclaration(), {"curves", nlohmann::json::object(), {{"plots", "curves", numbers, ""}}});
    if (!drawn) return Forward(drawn);
    if (Status copied = CopyWhole(drawn->artifact, picture); !copied) return copied;
    made_.files.push_back(picture);
    return {};
  }

  /// Suffix of the titles of curves.
  std::string Origin() const {
    const bool given = std::all_of(options_.data.begin(), options_.data.end(),
                                   [](const DataSetOptions& set) { return !set.path.empty(); });
    return std::string(" (") + (given ? "" : "substitute, ") + "profile " + options_.profile + ")";
  }

  /// Whether the curves include a metric of a set.
  bool Plots(const std::string& set, const std::string& metric) const {
    const std::vector<std::string>& plotted = options_.reproduce.plotted;
    return plotted.empty() || std::find(plotted.begin(), plotted.end(), set + "." + metric) != plotted.end();
  }

  void AddPoint(const std::string& set, const nlohmann::json& row,
                std::map<std::string, std::map<std::string, std::map<double, nlohmann::json>>>& curves) const {
    std::string name = row.at("name").get<std::string>();
    std::string number;
    const std::size_t comma = name.rfind(", "), under = set.rfind('_');
    const auto digits = [](const std::string& text) {
      std::string found;
      for (const char c : text) {
        if (std::isdigit(static_cast<unsigned char>(c)) != 0) found += c;
      }
      return found;
    };
    if (comma != std::string::npos) {
      number = digits(name.substr(comma));
      name.resize(comma);
    } else if (under != std::string::npos) {
      number = digits(set.substr(under));
    } else {
      number = "100";  // all of the data
    }
    const auto x = ParseDouble(number);
    if (!x) return;
    const nlohmann::json metrics = row.value("metrics", nlohmann::json::object());
    for (const auto& [metric, value] : metrics.items()) {
      if (!Plots(set, metric) || !value.is_object() || !value.at("value").is_number()) continue;
      nlohmann::json point = {{"x", *x}, {"y", value["value"]}};
      if (value.contains("interval") && value["interval"].is_array()) {
        point["low"] = value["interval"][0];
        point["high"] = value["interval"][1];
      }
      curves[metric][name][*x] = std::move(point);
    }
  }

  /// Makes the page of questions, and the figure, which is marked as without answers.
  Status MakeSurvey(const std::string& kind) {
    if (motions_.size() < 2) {
      Lose("survey '" + kind + "'", "it needs motions of two sources");
      return {};
    }
    SurveyMakeArguments asked;
    asked.kind = kind;
    asked.motions = motions_;
    if (kind == "real_or_fake") asked.real = kRealRow;
    asked.ask = options_.reproduce.pictures.front().labels;
    asked.output = run_.folder / "survey" / kind;
    asked.force = true;
    if (Status made = SurveyMakeVerb(own_, asked); !made) {
      if (Ends(made.error())) return made;
      Lose("survey '" + kind + "'", made.error().Message());
      return {};
    }
    SurveyTallyArguments tally;
    tally.key = asked.output / "key.json";
    tally.output = asked.output / "tally";
    tally.force = true;
    if (Status counted = SurveyTallyVerb(own_, tally); !counted) return counted;
    LogInfo("send " + DisplayPath(asked.output / "survey.html") + " to participants, then: mocurate survey tally " +
            DisplayPath(tally.key) + " answers_*.json -o DIR");
    made_.files.push_back(asked.output / "survey.html");
    made_.files.push_back(tally.output / "figure.svg");
    return {};
  }

  const JobOptions& options_;
  const ReproducedRun& run_;
  CommonArguments own_;
  std::vector<std::string> motions_;  ///< of the first picture, NAME=FILE
  PaperPictures made_;
};

}  // namespace

Expected<PaperPictures> MakePaperPictures(const JobOptions& options, const ReproducedRun& run) {
  return PictureMaker(options, run).Make();
}

}  // namespace mocurate
