#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/options.h"
#include "eval/options.h"
#include "fitting/options.h"
#include "ingest/options.h"
#include "report/options.h"
#include "train/items.h"

namespace mocurate {

/// Settings of the runner; they do not change results.
struct PipelineOptions {
  std::optional<double> item_timeout_s;     ///< absent: each stage's own (core/pipeline/stage.h)
  std::optional<double> item_memory_bytes;  ///< absent: each stage's own

  void Declare(OptionVisitor& v);
};

/// One of several sets that a run trains on and scores: `data: [{name, job, path, substitute}]`. A variant of another
/// set, such as one with held-out persons, is `{name, like, networks, evaluate}`.
struct DataSetOptions {
  std::string name;                   ///< of its folder and its part of the table
  std::string job;                    ///< config that makes its dataset: a name of configs/ or a file
  std::filesystem::path path;         ///< the user's copy; empty: the substitute
  std::string substitute_job;         ///< config that makes the substitute's dataset; empty: `job`
  std::string substitute;             ///< layout of the studio's substitute; empty: none
  std::string published;              ///< name of the set in published tables; empty: none
  std::string like;                   ///< an earlier set whose data, job and options this one inherits; empty: none
  std::vector<std::string> networks;  ///< "Ours.kl_weight=0.01"
  std::vector<std::string> evaluate;  ///< "test_reference=true"

  void Declare(OptionVisitor& v);
};

/// Item of a paper that a job reproduces: a table; a figure, or a study of its pictures and answers; `diagram`: a
/// drawing of the method, which has no numbers.
enum class PaperItem { kNone, kTable, kFigure, kStudy, kDiagram };

/// A skeleton of a picture: the bones of a person of the set, scaled.
struct DrawnSkeletonOptions {
  std::string name;
  std::string person;  ///< of the set
  std::string scale;   ///< as `generate --scale`; or empty

  void Declare(OptionVisitor& v);
};

/// A picture of motions in rows of equally spaced frames, made after a run: `samples` motions of each row and label.
struct DrawnMotionsOptions {
  std::string name;                    ///< of its files
  std::string set;                     ///< of the job's `data`; empty: the first
  std::vector<std::string> rows;       ///< networks, rows of `evaluate.rows`, or Real: the dataset
  std::vector<std::string> labels;     ///< classes; empty: all
  std::vector<std::string> scripts;    ///< instead of labels; a network of single actions makes each by itself
  std::vector<std::string> themes;     ///< of the scripts, in order
  std::int64_t transition_frames = 0;  ///< of each transition of scripts; 0: the network's usual number
  std::int64_t samples = 1;            ///< of each row and label
  std::int64_t stills = 10;            ///< frames of a row
  bool over_training = false;          ///< each network after every step of its `samples_at`, in a column of its own
  std::vector<DrawnSkeletonOptions> skeletons;  ///< each motion on each of these; empty: the network's own
  bool continues = false;                       ///< scripts continue motions of the set, which the rows begin with
  bool unseen_pairs = false;                    ///< the title names pairs of actions that training lacks
  bool path = false;                            ///< the root's path beside each row
  bool world = false;                           ///< rows in one view, over the floor of their first frame
  bool canonicalisation = false;                ///< no networks: frames in which a motion of the set is placed
  std::map<std::string, std::string> words;     ///< class -> the paper's word for it
  std::map<std::string, std::string> colours;   ///< row -> red, green or blue
  std::map<std::string, std::string> absent;    ///< row that the paper has and this project does not -> why

  void Declare(OptionVisitor& v);
};

/// Curves of an item: metrics of rows "NAME, step 4" or "NAME, 40 frames" over that number, or of sets "uestc_50".
struct PaperPlotOptions {
  std::string title;
  std::string metric;                         ///< SET.METRIC; without a set: of all sets
  std::string right;                          ///< a second metric, on the right axis; or empty
  std::map<std::string, std::string> curves;  ///< row -> name of its curve; empty: all rows, by their names
  std::vector<double> solid;                  ///< least and largest number of the training; dashed beyond; or empty

  void Declare(OptionVisitor& v);
};

/// A study of an item: motions of its rows on a page of questions.
struct PaperSurveyOptions {
  std::string kind;                 ///< of `mocurate survey make`
  std::vector<std::string> rows;    ///< as of DrawnMotionsOptions
  std::vector<std::string> labels;  ///< classes; empty: all
  std::int64_t samples = 1;         ///< motions of each row and label
  std::int64_t questions = 0;       ///< 0: the usual number
  std::string skeleton;             ///< that the motions are fitted to, for skinned bodies; empty: as they are

  void Declare(OptionVisitor& v);
};

/// Motions published by the authors, scored with their published recogniser: a row without training.
struct ReleasedMotionsOptions {
  std::string name;               ///< of the row
  std::string set;                ///< set of the job's `data` whose table contains the row
  std::string protocol;           ///< a name below configs/protocols
  std::filesystem::path motions;  ///< below MOCURATE_WEIGHTS, as all files here
  std::filesystem::path labels;
  std::filesystem::path bone_lengths;  ///< for Lie parameters: positions with the same bones; or empty
  std::string method;                  ///< the paper's name of the method

  void Declare(OptionVisitor& v);
};

/// Item of a paper that the job reproduces (mocurate reproduce).
struct ReproduceOptions {
  PaperItem kind = PaperItem::kNone;
  std::string shows;       ///< content of the paper's item
  std::string conclusion;  ///< conclusion of the paper, where its numbers are not available
  std::string recipe;      ///< whose clip counts by class are the table's rows; or empty
  std::string parts_of;    ///< network whose parameter counts by part are the table's rows; or empty
  double smoke_hours = 0.0, small_hours = 0.0, paper_hours = 0.0;  ///< on two cores; 0: not measured
  std::map<std::string, std::string> published_as;                 ///< row -> method of the published table; "": none
  std::string curve;  ///< rows "NAME N" are points of a curve over N, which has this name; or empty
  std::vector<PaperPlotOptions> plots;
  std::vector<ReleasedMotionsOptions> released;
  std::vector<DrawnMotionsOptions> pictures;
  std::vector<PaperSurveyOptions> surveys;
  bool screens = false;  ///< pictures of the surveys' pages

  void Declare(OptionVisitor& v);
};

/// Where the tasks of a run are executed.
enum class Executor { kLocal, kSlurm };
/// Where jobs of Slurm are submitted after the first: in jobs, or by the waiting front end.
enum class SubmitFrom { kCompute, kLogin };

/// What a job asks Slurm for; absent values leave it to the cluster.
struct SlurmResources {
  std::string partition;
  std::optional<double> time_s;
  std::optional<double> memory_bytes;
  std::int64_t cores = 1;

  void Declare(OptionVisitor& v);
};

/// Settings of `executor: slurm`; they do not change results.
struct SlurmOptions {
  std::string account;
  SlurmResources tasks{};  ///< of each task of an array
  SlurmResources step{};   ///< of the jobs between stages; empty partition: that of the tasks
  SlurmResources last{};   ///< of the job that assembles, trains and scores; empty partition: that of the tasks
  double task_time_s = 600.0;
  std::int64_t pilot = 32;      ///< items executed before a stage is cut for the first time, to know how long they take
  std::int64_t at_once = 0;     ///< tasks of an array that run at the same time; 0: no limit
  std::int64_t most_tasks = 0;  ///< of an array; 0: what the cluster allows
  std::string scratch;          ///< shell text, e.g. "$TMPDIR"
  std::vector<std::string> prologue;
  std::vector<std::string> sbatch;  ///< further options
  std::string program;              ///< shell text; empty: this program
  SubmitFrom submit_from = SubmitFrom::kCompute;

  void Declare(OptionVisitor& v);
};

/// A whole job, as in a config file: one group per stage, in order.
struct JobOptions {
  std::string name = "run";
  std::string description;
  std::string takes;                 ///< duration of the job, in words
  std::string skeleton = "smpl24";   ///< for stages that do not name their own
  double tolerated_failures = 0.0;   ///< share of failed clips above which the exit code is 1
  double tolerated_suspect = 0.5;    ///< share of clips with a finding of severity error above which the exit code is 1
  std::string profile;               ///< profile of the config's `profiles` to merge into it
  std::vector<DataSetOptions> data;  ///< several sets instead of one; empty: the job's own
  std::vector<std::string> substitutes;      ///< studio options of all substitutes, e.g. "subjects=3"
  std::vector<std::string> network_options;  ///< of a run over several sets, before those of each: "actor.layers=4"
  IngestOptions ingest;
  ProportionsSettings proportions;
  FittingOptions fitting;
  CanonOptions canon;
  AssembleOptions assemble;
  AuditOptions audit;
  TrainOptions train;
  EvaluateOptions evaluate;
  ReportOptions report;
  ReproduceOptions reproduce;
  PipelineOptions pipeline;
  Executor executor = Executor::kLocal;
  SlurmOptions slurm;
  bool allow_include = false;  ///< of the command line, not an option: for configurations that the job names

  void Declare(OptionVisitor& v);
};

/// Name of the network whose features the metrics use: the one that `evaluate` names, else the first recogniser of the
/// dataset; empty without one.
std::string RecogniserOf(const JobOptions& options);

/// Sets inherited values: the skeleton of stages without their own, the split of `evaluate` from the recogniser's.
void ResolveDefaults(JobOptions& options);

/// A set that is `like` another inherits its job, path and substitute where it has none; the other's options precede
/// its own. Error kConfig when no earlier set has that name.
Status ResolveDataSets(std::vector<DataSetOptions>& sets);

/// Options of the items of these stages. Files that they name are inputs of the items: their content is part of the
/// keys, not their paths.
nlohmann::json ProportionsItemOptions(const JobOptions& options);
nlohmann::json FittingItemOptions(const JobOptions& options);
nlohmann::json CanonItemOptions(const JobOptions& options);

}  // namespace mocurate
