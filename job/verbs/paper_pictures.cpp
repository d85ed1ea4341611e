#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"
#include "core/store/store.h"
#include "job/run_folder.h"
#include "job/verbs/generate.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/page_screen.h"
#include "job/verbs/reproduce.h"
#include "report/charts.h"
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
  bool single = false;  ///< makes each action of a script by itself
};

/// A set of motions and what the picture calls it.
struct DrawnSet {
  std::string name;
  fs::path file;
};

class PictureMaker {
 public:
  PictureMaker(const JobOptions& options, const ReproducedRun& run) : options_(options), run_(run), own_(run.common) {
    own_.json = false;
    own_.quiet = true;
  }

  Expected<PaperPictures> Make() {
    auto stages = VerbStages::Make(own_);
    if (!stages) return Forward(stages);
    stages_ = std::move(*stages);
    for (const DrawnMotionsOptions& picture : options_.reproduce.pictures) {
      if (Status drawn = Finished("picture '" + picture.name + "'", Draw(picture)); !drawn) return Forward(drawn);
    }
    if (!options_.reproduce.plots.empty()) {
      if (Status drawn = DrawCurves(); !drawn) return Forward(drawn);
    }
    for (const PaperSurveyOptions& survey : options_.reproduce.surveys) {
      if (Status made = Finished("survey '" + survey.kind + "'", MakeSurvey(survey)); !made) return Forward(made);
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

  /// The error of a part, if it ends everything; else the part is lost.
  Status Finished(const std::string& what, const Status& made) {
    if (made || Ends(made.error())) return made;
    Lose(what, made.error().Message());
    return {};
  }

  const DataSetOptions& SetOf(const std::string& name) const {
    const auto found = std::find_if(options_.data.begin(), options_.data.end(),
                                    [&](const DataSetOptions& set) { return set.name == name; });
    return found == options_.data.end() ? options_.data.front() : *found;
  }

  /// Folder of a set, if it is done.
  Expected<fs::path> FolderOf(const DataSetOptions& set) const {
    if (run_.sets.done.count(set.name) > 0) return run_.folder / "data" / set.name;
    return Fail(ErrorCode::kTooManyFailures, "set " + set.name + " failed", set.name);
  }

  /// Origin of what a picture of these sets shows.
  std::string CornerOf(const std::vector<const DataSetOptions*>& sets) const {
    std::string text = "profile " + options_.profile;
    for (const DataSetOptions* set : sets) {
      if (!set->like.empty()) continue;
      text += "; " + set->name + (set->path.empty() ? ": stand-in by the studio" : ": your copy");
    }
    return text;
  }

  /// Whether an output is of an earlier run.
  bool Earlier(const fs::path& file) const {
    return IsStale(run_.stale, DisplayPath(file.lexically_relative(run_.folder)));
  }

  const NetworkOptions* NetworkNamed(const std::string& name) const {
    for (const NetworkOptions& network : options_.train.networks) {
      if (network.name == name) return &network;
    }
    return nullptr;
  }

  /// Empty where it was not trained.
  fs::path CheckpointOf(const std::string& network, const fs::path& folder) const {
    const NetworkOptions* one = NetworkNamed(network);
    if (one == nullptr) return {};
    const fs::path file = folder / "checkpoints" / (FileNameOf(EndItem(*one, one->seed())) + ".h5");
    std::error_code unknown;
    return fs::is_regular_file(file, unknown) && !Earlier(file) ? file : fs::path();
  }

  /// Checkpoints of a network after its samples_at, which a profile may change, then at its end.
  std::vector<fs::path> StepsOfTraining(const fs::path& last) const {
    std::map<std::int64_t, fs::path> steps;
    std::error_code unknown;
    const std::string stem = last.stem().string(), begin = stem.substr(0, stem.find('@')) + "@";
    for (const fs::directory_entry& entry : fs::directory_iterator(last.parent_path(), unknown)) {
      const std::string name = entry.path().stem().string();
      const auto step = name.rfind(begin, 0) == 0 ? ParseInteger(name.substr(begin.size())) : std::nullopt;
      if (step && name != stem && !Earlier(entry.path())) steps[*step] = entry.path();
    }
    std::vector<fs::path> files;
    for (const auto& [step, file] : steps) files.push_back(file);
    files.push_back(last);
    return files;
  }

  std::optional<DrawnRow> RowOf(const std::string& name, const fs::path& folder) const {
    DrawnRow row;
    row.name = name;
    row.real = name == kRealRow;
    row.checkpoint = CheckpointOf(name, folder);
    row.single = !row.real;
    for (const ScriptRowOptions& asked : options_.evaluate.rows) {
      if (asked.name != name) continue;
      row = {name, CheckpointOf(asked.network, folder), {}, {}, asked.align, false, false};
      if (!asked.first.empty()) row.first = CheckpointOf(asked.first, folder);
      if (!asked.fill.empty()) row.fill = CheckpointOf(asked.fill, folder);
      if ((!asked.first.empty() && row.first.empty()) || (!asked.fill.empty() && row.fill.empty())) row.checkpoint = "";
    }
    if (row.checkpoint.empty() && !row.real) return std::nullopt;
    return row;
  }

  /// The file for generated motions of a row.
  Expected<fs::path> NewFile(const std::string& picture, const std::string& row) const {
    const fs::path file = run_.folder / "motions" / (FileNameOf(picture + "_" + row) + ".h5");
    if (Status made = MakeFolder(file.parent_path()); !made) return Forward(made);
    return file;
  }

  /// Motions of labels by a network, `samples` of each.
  Expected<fs::path> Generated(const std::string& picture, const std::string& name, GenerateArguments asked,
                               const std::vector<std::string>& labels, std::int64_t samples) {
    const auto file = NewFile(picture, name);
    if (!file) return Forward(file);
    asked.output = *file;
    asked.force = true;
    for (const std::string& label : labels) asked.labels.push_back(label + ":" + std::to_string(samples));
    if (Status generated = GenerateVerb(own_, asked); !generated) return Forward(generated);
    return *file;
  }

  /// Labels of which a dataset has no clip, though it has the class; each is lost.
  Expected<std::set<std::string>> LabelsWithout(const std::string& what, const std::vector<std::string>& labels,
                                                const fs::path& dataset) {
    const auto set = DatasetClips::Open(dataset, DatasetClips::Check::kNone);
    if (!set) return Forward(set);
    std::set<std::string> without(labels.begin(), labels.end());
    for (std::size_t row = 0; row < set->size(); ++row) without.erase(set->Label(row));
    for (const std::string& label : without) Lose(what + ", label '" + label + "'", "the set has no motion of it");
    return without;
  }

  /// The motions of a row.
  Expected<fs::path> MotionsOf(const DrawnMotionsOptions& picture, const DrawnRow& row, const fs::path& folder) {
    const fs::path dataset = folder / "dataset.h5";
    if (row.real) return dataset;
    GenerateArguments asked;
    asked.checkpoint = row.checkpoint;
    if (picture.scripts.empty()) return Generated(picture.name, row.name, asked, picture.labels, picture.samples);
    if (row.single) {
      std::vector<std::string> actions;
      for (const std::string& text : picture.scripts) {
        const auto script = ReadScript(text);
        if (!script) return Forward(script);
        for (const ScriptActionOptions& action : script->actions) actions.push_back(action.action);
      }
      return Generated(picture.name, row.name, asked, actions, 1);
    }
    asked.scripts = picture.scripts;
    asked.transition_frames = static_cast<int>(picture.transition_frames);
    asked.count = static_cast<int>(picture.samples);
    asked.first = picture.continues ? fs::path() : row.first;
    asked.fill = row.fill;
    asked.align = row.align;
    asked.keep_previous = picture.continues;
    if (picture.continues) asked.previous = dataset;
    return Generated(picture.name, row.name, asked, {}, 0);
  }

  /// The sets of a row: one, or one for each step of training or each skeleton. `shown` receives columns.
  Expected<std::vector<DrawnSet>> SetsOf(const DrawnMotionsOptions& picture, const DrawnRow& row,
                                         const fs::path& folder, MotionPictureOptions& shown) {
    std::vector<DrawnSet> sets;
    GenerateArguments asked;
    asked.checkpoint = row.checkpoint;
    if (picture.over_training) {
      for (const fs::path& checkpoint : StepsOfTraining(row.checkpoint)) {
        const auto network = ReadCheckpoint(checkpoint);
        if (!network) return Forward(network);
        asked.checkpoint = checkpoint;
        const std::string name = row.name + ", " + Counted(network->step, "iteration");
        const auto file = Generated(picture.name, name, asked, picture.labels, picture.samples);
        if (!file) return Forward(file);
        shown.columns[name] = row.name;
        sets.push_back({name, *file});
      }
      return sets;
    }
    for (const DrawnSkeletonOptions& skeleton : picture.skeletons) {
      asked.bone_lengths = folder / "dataset.h5";
      asked.person = skeleton.person;
      asked.scale = skeleton.scale;
      const auto file = Generated(picture.name, skeleton.name, asked, picture.labels, picture.samples);
      if (!file) return Forward(file);
      sets.push_back({skeleton.name, *file});
    }
    if (!sets.empty()) return sets;
    const auto file = MotionsOf(picture, row, folder);
    if (!file) return Forward(file);
    if (row.single && !picture.scripts.empty()) shown.joined.push_back(row.name);
    return std::vector<DrawnSet>{{row.name, *file}};
  }

  /// Successive actions of the scripts that no training sample has: "squat to jump".
  Expected<std::string> UnseenPairs(const DrawnMotionsOptions& picture, const fs::path& dataset) const {
    const auto set = ReadDataset(dataset);
    if (!set) return Forward(set);
    std::vector<int> rows = set->splits.empty() ? std::vector<int>() : set->splits.front().train;
    if (rows.empty()) {
      rows.resize(set->clips.size());
      std::iota(rows.begin(), rows.end(), 0);
    }
    std::set<std::pair<std::string, std::string>> seen, unseen;
    for (const int row : rows) {
      const std::vector<Segment>& parts = set->clips[static_cast<std::size_t>(row)].segments;
      if (parts.size() > 1) seen.emplace(parts.front().label, parts.back().label);
    }
    for (const std::string& text : picture.scripts) {
      const auto script = ReadScript(text);
      if (!script) return Forward(script);
      for (std::size_t k = 1; k < script->actions.size(); ++k) {
        const std::pair pair(script->actions[k - 1].action, script->actions[k].action);
        if (seen.count(pair) == 0) unseen.insert(pair);
      }
    }
    std::vector<std::string> texts;
    for (const auto& [before, after] : unseen) texts.push_back(before + " to " + after);
    return JoinTexts(texts);
  }

  Status Draw(const DrawnMotionsOptions& whole) {
    DrawnMotionsOptions picture = whole;
    const DataSetOptions& set = SetOf(picture.set);
    const auto folder = FolderOf(set);
    if (!folder) return Forward(folder);
    const auto without = LabelsWithout("picture '" + picture.name + "'", picture.labels, *folder / "dataset.h5");
    if (!without) return Forward(without);
    for (const std::string& label : *without) {
      picture.absent[label] = "the set has no motion of it";
      picture.labels.erase(std::find(picture.labels.begin(), picture.labels.end(), label));
    }
    if (picture.labels.empty() && !whole.labels.empty()) return {};
    MotionPictureOptions shown;
    shown.title = options_.reproduce.shows;
    shown.corner = CornerOf({&set});
    shown.samples = picture.samples * std::max<std::int64_t>(1, static_cast<std::int64_t>(picture.scripts.size()));
    shown.stills = picture.stills;
    shown.figure = FigureChoice::kCapsules;
    shown.themes = picture.themes;
    shown.words = picture.words;
    shown.colours = picture.colours;
    shown.absent = picture.absent;
    shown.world = picture.world;
    shown.path = picture.path;
    if (picture.scripts.empty()) shown.labels = picture.labels;
    std::vector<DrawnSet> sets;
    if (picture.canonicalisation) {
      const auto file = NewFile(picture.name, "placed");
      if (!file) return Forward(file);
      const auto placed = PlacedByEachRule(*folder / "dataset.h5", *file);
      if (!placed) return Forward(placed);
      for (const auto& [name, path] : placed->sets) sets.push_back({name, path});
      shown.labels = placed->labels;
      shown.colours = placed->colours;
      shown.scene = true;
    }
    for (const std::string& name : picture.rows) {
      const auto row = RowOf(name, *folder);
      auto own = row ? SetsOf(picture, *row, *folder, shown)
                     : Fail(ErrorCode::kTooManyFailures, "its network is not trained", name);
      if (!own && Ends(own.error())) return Forward(own);
      if (!own) {
        Lose("picture '" + picture.name + "', row '" + name + "'", own.error().Message());
        shown.absent[name] = own.error().what;
        continue;
      }
      sets.insert(sets.end(), own->begin(), own->end());
    }
    if (sets.empty()) return {};
    if (picture.unseen_pairs) {
      const auto unseen = UnseenPairs(picture, *folder / "dataset.h5");
      if (!unseen) return Forward(unseen);
      shown.title += "; pairs of actions that training lacks: " + (unseen->empty() ? "none" : *unseen);
    }
    ItemSpec item{"motions", nlohmann::json(), {}};
    for (const DrawnSet& one : sets) item.inputs.push_back({"motions", one.name, one.file, ""});
    return WritePicture(std::move(item), OptionsToJson(shown), picture.name);
  }

  /// pictures/NAME.svg and .png, and NAME.json with what they show.
  Status WritePicture(ItemSpec item, nlohmann::json options, const std::string& name) {
    const fs::path folder = run_.folder / "pictures";
    if (Status made = MakeFolder(folder); !made) return made;
    for (const char* format : {"svg", "png"}) {
      options["format"] = format;
      item.options = options;
      const auto drawn = stages_->One(MotionPictureDeclaration(), item);
      if (!drawn) return Forward(drawn);
      const fs::path file = folder / (name + "." + format);
      if (Status copied = CopyWhole(drawn->artifact, file); !copied) return copied;
      made_.files.push_back(file);
      for (const nlohmann::json& row : drawn->summary.at("shown")) {
        const std::string why = row.at("absent"), source = row.at("source");
        if (why.empty() || options.at("absent").contains(source) || format != std::string("svg")) continue;
        Lose("picture '" + name + "', row '" + source + "' of " + row.at("label").get<std::string>(), why);
      }
      const nlohmann::json json = {
          {"title", options.at("title")}, {"corner", options.at("corner")}, {"rows", drawn->summary.at("shown")}};
      if (Status written = WriteFile(folder / (name + ".json"), json.dump(1) + "\n"); !written) return written;
    }
    return {};
  }

  // Curves.

  using Curves = std::map<std::string, std::map<double, PlotPoint>>;  // points by row and x

  /// The number of a row "NAME, step 4" or of a set "uestc_50", and NAME.
  static std::optional<std::pair<std::string, double>> PlaceOf(const std::string& set, std::string name) {
    const auto digits = [](const std::string& text) {
      std::string found;
      for (const char c : text) {
        if (std::isdigit(static_cast<unsigned char>(c)) != 0) found += c;
      }
      return found;
    };
    const std::size_t comma = name.rfind(", "), under = set.rfind('_');
    std::string number = "100";  // all of the data
    if (comma != std::string::npos) {
      number = digits(name.substr(comma));
      name.resize(comma);
    } else if (under != std::string::npos) {
      number = digits(set.substr(under));
    }
    const auto x = ParseDouble(number);
    return x ? std::optional(std::pair(name, *x)) : std::nullopt;
  }

  /// Points of "SET.METRIC" or "METRIC" of all sets.
  Curves PointsOf(const std::string& wanted) const {
    Curves curves;
    const std::size_t point = wanted.find('.');
    const std::string metric = point == std::string::npos ? wanted : wanted.substr(point + 1);
    for (const DataSetOptions& set : options_.data) {
      if (run_.sets.done.count(set.name) == 0) continue;
      if (point != std::string::npos && wanted.substr(0, point) != set.name) continue;
      for (const char* table : {"table.json", "recognition.json"}) {
        const fs::path file = run_.folder / "data" / set.name / "tables" / table;
        if (Earlier(file)) continue;
        const nlohmann::json json = ReadJson(file).value_or(nullptr);
        if (!json.is_object()) continue;
        for (const nlohmann::json& row : json.value("rows", nlohmann::json::array())) {
          const auto place = PlaceOf(set.name, row.at("name").get<std::string>());
          const nlohmann::json value = row.value("metrics", nlohmann::json::object()).value(metric, nlohmann::json());
          if (!place || !value.is_object() || !value.at("value").is_number()) continue;
          PlotPoint at{place->second, value["value"].get<double>()};
          if (value.contains("interval") && value["interval"].is_array()) {
            at.low = value["interval"][0].get<double>();
            at.high = value["interval"][1].get<double>();
          }
          curves[place->first][place->second] = at;
        }
      }
    }
    return curves;
  }

  /// Adds the curves of a metric that a plot shows.
  void AddCurves(const PaperPlotOptions& asked, const std::string& metric, Plot& plot) const {
    for (const auto& [row, points] : PointsOf(metric)) {
      const auto named = asked.curves.find(row);
      if ((!asked.curves.empty() && named == asked.curves.end()) || points.size() < 2) continue;
      PlotCurve curve{asked.curves.empty() ? row : named->second, {}, -1, metric == asked.right};
      if (!asked.right.empty()) curve.name += (curve.name.empty() ? "" : ": ") + MetricOf(metric);
      for (const auto& [x, point] : points) curve.points.push_back(point);
      plot.curves.push_back(std::move(curve));
    }
  }

  static std::string MetricOf(const std::string& text) { return text.substr(text.find('.') + 1); }

  Status DrawCurves() {
    std::vector<const DataSetOptions*> sets;
    for (const DataSetOptions& set : options_.data) sets.push_back(&set);
    PlotSheet sheet{options_.reproduce.shows, "", CornerOf(sets), {}, 2};
    for (const PaperPlotOptions& asked : options_.reproduce.plots) {
      Plot plot{asked.title, options_.reproduce.curve, MetricOf(asked.metric), {}, MetricOf(asked.right)};
      if (asked.solid.size() == 2) plot.solid = {asked.solid[0], asked.solid[1]};
      AddCurves(asked, asked.metric, plot);
      if (!asked.right.empty()) AddCurves(asked, asked.right, plot);
      for (const auto& [row, name] : asked.curves) {
        for (const std::string* metric : {&asked.metric, &asked.right}) {
          if (metric->empty() || PointsOf(*metric)[row].size() > 1) continue;
          const std::string curve = (name.empty() ? row : name) + ", " + MetricOf(*metric);
          Lose("plot '" + asked.title + "', curve '" + curve + "'", "the tables have less than two values of it");
          sheet.note += (sheet.note.empty() ? "Without values: " : "; ") + curve;
        }
      }
      sheet.plots.push_back(std::move(plot));
    }
    const fs::path picture = run_.folder / "pictures/curves.svg";
    if (Status made = MakeFolder(picture.parent_path()); !made) return made;
    if (Status written = WriteFile(run_.folder / "pictures/curves.json", sheet.Json().dump(1) + "\n"); !written) {
      return written;
    }
    if (Status written = WriteFile(picture, ToSvg(sheet.Draw())); !written) return written;
    made_.files.push_back(picture);
    return {};
  }

  // Studies.

  /// At most `samples` clips of each label of a dataset, evenly spaced, as a file of their own.
  Expected<fs::path> SomeOf(const fs::path& dataset, const PaperSurveyOptions& survey) const {
    auto set = ReadDataset(dataset);
    if (!set) return Forward(set);
    std::map<std::string, std::vector<std::size_t>> of_label;
    for (std::size_t i = 0; i < set->clips.size(); ++i) of_label[set->clips[i].label].push_back(i);
    std::set<std::size_t> chosen;
    for (const auto& [label, rows] : of_label) {
      const bool asked =
          survey.labels.empty() || std::find(survey.labels.begin(), survey.labels.end(), label) != survey.labels.end();
      const auto count = std::min(rows.size(), static_cast<std::size_t>(survey.samples));
      for (std::size_t k = 0; asked && k < count; ++k) chosen.insert(rows[k * rows.size() / count]);
    }
    std::vector<Clip> clips;
    for (const std::size_t row : chosen) clips.push_back(std::move(set->clips[row]));
    set->clips = std::move(clips);
    set->splits.clear();
    const auto file = NewFile(survey.kind, kRealRow);
    if (!file) return Forward(file);
    if (Status written = WriteDataset(*set, *file); !written) return Forward(written);
    return *file;
  }

  /// Motions of a source of a study.
  Expected<fs::path> SourceOf(const PaperSurveyOptions& survey, const std::string& name, const fs::path& folder) {
    const auto row = RowOf(name, folder);
    if (!row) return Fail(ErrorCode::kTooManyFailures, "its network is not trained", name);
    GenerateArguments asked;
    asked.checkpoint = row->checkpoint;
    auto file = row->real ? SomeOf(folder / "dataset.h5", survey)
                          : Generated(survey.kind, name, asked, survey.labels, survey.samples);
    if (!file || survey.skeleton.empty()) return file;
    FitArguments fit;
    fit.path = *file;
    fit.skeleton = survey.skeleton;
    fit.assignments = {"proportions.own_directions=false"};  // a skin needs the rest pose of its own skeleton
    const auto fitted = NewFile(survey.kind, name + "_fitted");
    if (!fitted) return Forward(fitted);
    fit.output = *fitted;
    std::error_code unknown;
    fs::remove(*fitted, unknown);
    const Status done = FitVerb(own_, fit);
    if (!done && (Ends(done.error()) || !fs::exists(*fitted, unknown))) return Forward(done);
    return *fitted;  // suspect fits are shown too
  }

  /// Makes the page of questions, and the figure, which is marked as without answers.
  Status MakeSurvey(PaperSurveyOptions survey) {
    const auto folder = FolderOf(options_.data.front());
    if (!folder) return Forward(folder);
    if (survey.labels.empty()) {
      const auto set = DatasetClips::Open(*folder / "dataset.h5", DatasetClips::Check::kNone);
      if (!set) return Forward(set);
      survey.labels = set->labels();
    }
    const auto without = LabelsWithout("survey '" + survey.kind + "'", survey.labels, *folder / "dataset.h5");
    if (!without) return Forward(without);
    for (const std::string& label : *without) {
      survey.labels.erase(std::find(survey.labels.begin(), survey.labels.end(), label));
    }
    if (survey.labels.empty()) {  // which would ask about all labels
      return Fail(ErrorCode::kInconsistent, "the set has no motion of any label of the study", DisplayPath(*folder));
    }
    SurveyMakeArguments asked;
    asked.kind = survey.kind;
    for (const std::string& name : survey.rows) {
      const auto file = SourceOf(survey, name, *folder);
      if (!file) return Forward(file);
      asked.motions.push_back(name + "=" + file->string());
    }
    if (survey.kind == "real_or_fake") asked.real = kRealRow;
    asked.ask = survey.labels;
    asked.questions = survey.questions;
    asked.output = run_.folder / "survey" / survey.kind;
    asked.force = true;
    if (Status made = SurveyMakeVerb(own_, asked); !made) return made;
    SurveyTallyArguments tally;
    tally.key = asked.output / "key.json";
    tally.output = asked.output / "tally";
    tally.corner = CornerOf({&options_.data.front()});
    tally.force = true;
    if (Status counted = SurveyTallyVerb(own_, tally); !counted) return counted;
    const fs::path page = asked.output / "survey.html";
    LogInfo("send " + DisplayPath(page) + " to participants, then: mocurate survey tally " + DisplayPath(tally.key) +
            " answers_*.json -o DIR");
    made_.files.push_back(page);
    made_.files.push_back(tally.output / "figure.svg");
    if (!options_.reproduce.screens) return {};
    const fs::path picture = run_.folder / "pictures" / (survey.kind + "_page.png");
    if (Status made = MakeFolder(picture.parent_path()); !made) return made;
    const Status taken = WriteScreen(page, tally.corner, picture);
    if (taken) made_.files.push_back(picture);
    return Finished("picture '" + survey.kind + "_page'", taken);
  }

  const JobOptions& options_;
  const ReproducedRun& run_;
  CommonArguments own_;
  std::unique_ptr<VerbStages> stages_;
  PaperPictures made_;
};

}  // namespace

Expected<PaperPictures> MakePaperPictures(const JobOptions& options, const ReproducedRun& run) {
  return PictureMaker(options, run).Make();
}

}  // namespace mocurate
