#pragma once

#include <filesystem>
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
