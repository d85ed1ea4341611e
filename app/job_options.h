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

/// How the stages are run; nothing here changes a result.
struct PipelineOptions {
  std::optional<double> item_timeout_s;     ///< absent: each stage's own (core/pipeline/stage.h)
  std::optional<double> item_memory_bytes;  ///< absent: each stage's own

  void Declare(OptionVisitor& v);
};

/// One of several sets that a run trains on and scores: `data: [{name, job, path, substitute}]`. A second reading of
/// one of them, such as its held-out persons, is `{name, like, networks, evaluate}`.
struct DataSetOptions {
  std::string name;                   ///< of its folder and its part of the table
  std::string job;                    ///< config that makes its dataset: a name of configs/ or a file
  std::filesystem::path path;         ///< the user's copy; empty: the substitute
  std::string substitute_job;         ///< config that makes the stand-in's dataset; empty: `job`
  std::string substitute;             ///< layout in which the studio writes a stand-in; empty: none
  std::string published;              ///< the set as published tables name it; empty: none
  std::string like;                   ///< name of a set before it whose data, job and options it takes; empty: none
  std::vector<std::string> networks;  ///< "Ours.kl_weight=0.01"
  std::vector<std::string> evaluate;  ///< "test_reference=true"

  void Declare(OptionVisitor& v);
};

/// What a job reproduces of a paper: a table; a figure or a study of its pictures and answers; `diagram`: a drawing of
/// the method, of which nothing can be computed.
enum class PaperItem { kNone, kTable, kFigure, kStudy, kDiagram };

/// A picture of motions in rows of equally spaced frames, made after a run: each row that is named, of each label, so
/// many samples.
struct DrawnMotionsOptions {
  std::string name;                    ///< of its files
  std::string set;                     ///< of the job's `data`; empty: the first
  std::vector<std::string> rows;       ///< networks, rows of `evaluate.rows`, or Real: the dataset
  std::vector<std::string> labels;     ///< classes; empty: all
  std::vector<std::string> scripts;    ///< in the place of labels, of networks that answer them
  std::int64_t transition_frames = 0;  ///< of all transitions of scripts; 0: usual ones
  std::int64_t samples = 1;            ///< of each row and label
  std::string frames;                  ///< of each motion, as `generate --frames`
  std::int64_t interpolate = 0;        ///< so many between two latents
  bool denoise = false;                ///< networks show clips of the dataset, encoded and decoded
  std::int64_t stills = 10;            ///< frames of a row

  void Declare(OptionVisitor& v);
};

/// Motions that the authors published, scored by the recogniser that they published: a row that nothing is trained for.
struct ReleasedMotionsOptions {
  std::string name;               ///< of the row
  std::string set;                ///< of the job's `data`, in whose table it stands
  std::string protocol;           ///< a name below configs/protocols
  std::filesystem::path motions;  ///< below MOCURATE_WEIGHTS, as all files here
  std::filesystem::path labels;
  std::filesystem::path bone_lengths;  ///< of motions that are Lie parameters: others, whose bones they have; or empty
  std::string method;                  ///< that the paper calls so

  void Declare(OptionVisitor& v);
};

/// What of a paper the job reproduces (mocurate reproduce).
struct ReproduceOptions {
  PaperItem kind = PaperItem::kNone;
  std::string shows;       ///< what the paper's item shows
  std::string conclusion;  ///< what the paper says of it where its numbers are not at hand
  std::string recipe;      ///< whose numbers of clips by class are the table's rows; or empty
  std::string parts_of;    ///< network whose numbers of parameters by part are the table's rows; or empty
  double smoke_hours = 0.0, small_hours = 0.0, paper_hours = 0.0;  ///< on two cores; 0: not measured
  std::map<std::string, std::string> published_as;                 ///< row -> method that the paper calls so; "": none
  std::string curve;                 ///< rows "NAME N" are points of a curve over N, which has this name; or empty
  std::vector<std::string> plotted;  ///< "SET.METRIC" of the curves; empty: all
  std::vector<ReleasedMotionsOptions> released;
  std::vector<DrawnMotionsOptions> pictures;
  std::vector<std::string> surveys;  ///< kinds of `mocurate survey make`, of the motions of the first picture

  void Declare(OptionVisitor& v);
};

/// A whole job, as a config file says it: one group per stage, in order.
struct JobOptions {
  std::string name = "run";
  std::string description;
  std::string takes;                     ///< how long the job takes, in words
  std::string skeleton = "smpl24";       ///< for stages that do not name their own
  double tolerated_failures = 0.0;       ///< share of clips that may fail before the exit code is 1
  double tolerated_doubtful = 0.5;       ///< share of clips with a finding of severity error before the exit code is 1
  std::string profile;                   ///< which of the config's `profiles` is merged into it
  std::vector<DataSetOptions> data;      ///< several sets in the place of one; empty: the job's own
  std::vector<std::string> substitutes;  ///< studio options of all substitutes, e.g. "subjects=3"
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

  void Declare(OptionVisitor& v);
};

/// Name of the network that gives the features of the metrics: the one that `evaluate` names, else the first recogniser
/// of the dataset; empty where there is none.
std::string RecogniserOf(const JobOptions& options);

/// Fills what groups take from each other:
/// the skeleton of stages that do not name their own, the split of `evaluate` from the recogniser's.
void ResolveDefaults(JobOptions& options);

/// A set that is `like` another takes its job, path and substitute where it has none, and its options before its own.
/// Error kConfig when no set before it has that name.
Status ResolveDataSets(std::vector<DataSetOptions>& sets);

/// Options of the stage `proportions`: its own group, with the method and clouds of `fitting`.
ProportionsOptions ProportionsOf(const JobOptions& options);

}  // namespace mocurate
