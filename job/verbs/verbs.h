#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

struct LoadedJob;

/// Options of every verb. With `json` the result is one JSON document on stdout; logs always go to stderr.
struct CommonArguments {
  bool json = false;
  bool quiet = false;  ///< errors only: no text of the result, no progress, no warning
  bool verbose = false;
  bool allow_include = false;  ///< configurations may include files from anywhere (ConfigRules)
  bool answered = false;       ///< the verb has printed its JSON document: an error is not printed as another one
};

struct RunArguments {
  std::filesystem::path config;                 ///< name of a job or file; empty: the embedded default
  std::optional<std::filesystem::path> output;  ///< run folder; absent: runs/NAME
  std::vector<std::string> assignments;
  std::string to;  ///< last stage; empty: report
  int jobs = 0;
  bool dry_run = false;
  std::vector<std::string> data;  ///< NAME=PATH of sets, in a run over several
  double budget = 1.0;            ///< trains this many times longer than the config says
  std::filesystem::path plan;     ///< file of a plan, of which one task runs; or empty
  std::optional<std::size_t> task;
  std::filesystem::path scratch;  ///< folder on a disk of this node for outputs until they are complete; or empty
  std::string executor;           ///< local or slurm, instead of the configuration's; empty: as there
  bool no_wait = false;           ///< do not follow the jobs of Slurm
  bool replace = false;           ///< use the folder of another job
};

struct JobsArguments {
  std::filesystem::path run;
  bool next = false;             ///< plan and submit the next stage
  bool last = false;             ///< do the stages after the arrays
  std::filesystem::path config;  ///< of the run, with its assignments: --next and --last go on with it
  std::vector<std::string> assignments;
};

struct PlanArguments {
  std::filesystem::path config;
  std::vector<std::string> assignments;
  std::string stage;
  std::optional<std::filesystem::path> output;  ///< run folder; absent: runs/NAME
  std::optional<std::size_t> tasks;
  double task_minutes = 10.0;
  std::size_t leftovers = 32;  ///< missing items of earlier stages that are executed at once, at most
  int cores = 1;               ///< of a task
  int jobs = 0;                ///< of the pilot
  bool replace = false;        ///< use the folder of another job
};

struct FitArguments {
  std::filesystem::path path;      ///< captures or motions: a file or a folder
  std::string source;              ///< source declaration or config; empty: estimated from the files
  std::vector<std::string> clips;  ///< selected clips; empty: all
  std::string skeleton;            ///< of the fitted motion; empty: smpl24, or the motion's own where it has rotations
  std::filesystem::path output;    ///< dataset of the fitted clips
  std::vector<std::string> assignments;
  int jobs = 0;
  bool contacts = false;  ///< remove foot sliding
  bool force = false;     ///< overwrite
};

struct RigAuditArguments {
  std::filesystem::path config;    ///< name of a job or file
  std::filesystem::path output;    ///< file of the rig (YAML)
  std::vector<std::string> clips;  ///< selected takes; empty: all
  std::vector<std::string> assignments;
  int jobs = 0;
  bool force = false;  ///< overwrite
};

/// --layout of a recogniser's folder; the others are of clips.
inline constexpr const char* kExtractorLayout = "extractor";

struct ExportArguments {
  std::filesystem::path path;         ///< a file or folder of motions
  std::filesystem::path output;       ///< a folder, or a file of the layout's ending
  std::string source;                 ///< source declaration; empty: declared by the files
  std::string layout;                 ///< a name of Layouts(), or kExtractorLayout; empty: by the ending of the output
  std::string rotations;              ///< a name of kRotationArraysNames; empty: the layout's own
  std::string split;                  ///< split to write; empty: all, or the first where a layout has only one
  std::vector<std::string> clips;     ///< selected clips; empty: all
  bool keep_inferred = false;         ///< frames without an observation go into layouts that cannot mark them
  bool force = false;                 ///< overwrite
  std::vector<std::string> tolerate;  ///< codes of findings for which no clip is refused
};

struct GenerateArguments {
  std::filesystem::path checkpoint;
  std::vector<std::string> labels;   ///< "LABEL:COUNT"; empty: each class once
  std::string frames;                ///< "60" or "40:120:5"; empty: as in training
  int interpolate = 0;               ///< motions between two latents, for each requested one; 0: none
  std::vector<std::string> scripts;  ///< "throw,catch:30", a name of configs/scripts, or a file; a motion each
  int count = 1;                     ///< motions of each script
  int transition_frames = 0;         ///< of each transition of scripts; 0: as in the script or the network
  std::filesystem::path first;       ///< checkpoint that makes the first action of scripts, or empty
  std::filesystem::path fill;        ///< checkpoint that fills transitions between joined actions, or empty
  std::filesystem::path previous;    ///< dataset whose motions scripts continue, or empty
  std::string previous_clip;         ///< id of the motion to continue; empty: drawn
  bool keep_previous = false;        ///< answers begin with the motion that they continue
  bool align = false;                ///< rotate and move joined actions
  bool snap = false;                 ///< continuations start at the last frame's place and heading
  std::filesystem::path denoise;     ///< dataset whose clips are encoded and decoded, or empty
  std::uint64_t seed = 1;
  std::string scale;                   ///< "legs=1.25,arms=1.25"
  std::filesystem::path bone_lengths;  ///< dataset whose mean bone lengths the motions get, or empty
  std::string person;                  ///< of that dataset, whose bones alone count; empty: all
  std::filesystem::path mesh;          ///< folder for the motions as meshes, or empty
  std::filesystem::path body;          ///< of the meshes; empty: the one that losses on vertices use
  int shapes = 1;                      ///< number of bodies per motion
  std::filesystem::path output;
  bool force = false;  ///< overwrite
};

struct DrawArguments {
  std::vector<std::string> motions;    ///< files or folders; NAME=PATH names the row
  std::string source;                  ///< source declaration of them, or empty
  std::vector<std::string> labels;     ///< classes to show; empty: all
  std::vector<std::string> clips;      ///< ids or their ends, instead of labels
  int samples = 1;                     ///< of each label and set
  int stills = 10;                     ///< frames of a row
  std::string figure = "bones";        ///< bones, capsules, skin
  std::string view = "three-quarter";  ///< or front, side, "AZIMUTH,ELEVATION" in degrees
  std::filesystem::path body;          ///< of a skin; empty: the one that losses on vertices use
  std::string title;
  double scale = 2.0;                 ///< pixels of a PNG or video for each unit of the drawing
  std::filesystem::path output;       ///< .svg, .png or .mp4
  bool force = false;                 ///< overwrite
  std::vector<std::string> tolerate;  ///< codes of findings for which no clip is refused
};

struct ViewArguments {
  std::vector<std::string> motions;  ///< files, folders or runs; NAME=PATH names the source
  std::string source;                ///< source declaration of them, or empty
  std::vector<std::string> clips;    ///< ids or their ends; empty: all
  std::filesystem::path body;        ///< of a skin; empty: body_cc0.h5 where it is found
  bool audit = false;                ///< a map of the clips, the nearest of each, and what an audit finds
  std::string title;
  std::filesystem::path output;       ///< .html; empty: a temporary page, which is opened
  bool force = false;                 ///< overwrite
  std::vector<std::string> tolerate;  ///< codes of findings for which no clip is refused
};

struct ReproduceArguments {
  std::string id;                               ///< "actor/table3", or "list"
  std::vector<std::string> data;                ///< NAME=PATH
  std::string profile;                          ///< smoke, small, paper; empty: small
  std::string time_budget;                      ///< "20min"; empty: the profile's duration
  std::optional<std::filesystem::path> output;  ///< run folder; absent: runs/PAPER_ID_PROFILE
  std::vector<std::string> assignments;
  int jobs = 0;
  bool dry_run = false;
  bool replace = false;  ///< use the folder of another job
};

struct EvalArguments {
  std::string protocol;
  std::vector<std::string> generated;          ///< files or folders of motions; NAME=PATH names the row
  std::vector<std::filesystem::path> labels;   ///< of each of the generated sets, one for all, or none
  std::vector<std::filesystem::path> lengths;  ///< numbers of frames of the motions, likewise
  std::string padding;                         ///< cut (or empty), keep: only counted
  std::string source;                          ///< source declaration of the generated motions, or empty
  std::string values;                          ///< joints, lie; empty: joints, lie with bone_lengths
  std::filesystem::path bone_lengths;          ///< motions whose median bone lengths are used for Lie parameters
  std::filesystem::path real;
  std::string real_source;            ///< source declaration of the real motions, or empty
  std::filesystem::path real_labels;  ///< labels of the real motions, or empty
  std::filesystem::path run;          ///< run folder whose first recogniser scores
  std::string extractor;              ///< instead of the protocol's
  std::filesystem::path output;       ///< folder for features, tables and figures, or empty
  std::vector<std::string> assignments;
  bool dose_response = false;          ///< only damaged copies of real motions are scored
  std::filesystem::path damaged_real;  ///< the motions to damage; empty: those of the run
  std::vector<std::string> doses;      ///< as of ParseDoses; empty: all damages
  std::uint64_t seed = 1;              ///< of the damages
  int jobs = 0;
  std::vector<std::string> tolerate;  ///< codes of findings for which no clip is refused
  std::vector<std::string> fits;      ///< datasets or run folders to compare with `truth` instead; NAME=PATH
  std::filesystem::path truth;        ///< file or folder of ground truth, or a dataset
};

struct AuditArguments {
  std::filesystem::path path;           ///< dataset
  std::filesystem::path probabilities;  ///< features of its clips by `mocurate eval`, or empty
  std::filesystem::path output;         ///< folder for audit.json and a page, or empty
  std::filesystem::path review;         ///< decisions; findings with the decision keep are not reported again; or empty
  std::filesystem::path with_findings;  ///< file for the dataset with its findings, or empty
  std::filesystem::path fixes;          ///< file for safe decisions, or empty
  std::string fail_on;                  ///< "warning", "error", or empty
  std::vector<std::string> assignments;
  bool force = false;  ///< overwrite
};

struct ReviewArguments {
  std::filesystem::path path;           ///< dataset
  std::filesystem::path output;         ///< page
  std::filesystem::path audit;          ///< audit.json of it; empty: run the audit
  std::filesystem::path decisions;      ///< of an earlier session, or empty
  std::filesystem::path probabilities;  ///< as of AuditArguments
  std::vector<std::string> assignments;
  int most = 200;                     ///< findings shown
  bool annotate = false;              ///< a page for marking spans instead, with the next five options
  std::optional<std::string> labels;  ///< "walk,run"; absent: those of the recipe, else the dataset's classes
  std::string recipe;                 ///< name or file whose classes are the labels, or empty
  std::filesystem::path spans;        ///< of an earlier session, or empty
  std::vector<std::string> clips;     ///< selected clips; empty: all without a label
  bool all = false;                   ///< labelled clips as well
  bool force = false;                 ///< overwrite
};

struct SurveyMakeArguments {
  std::string kind;                           ///< ranking, real_or_fake
  std::vector<std::string> motions;           ///< NAME=FILE of each source
  std::string real;                           ///< source of recordings; empty: "real"
  std::int64_t questions = 0;                 ///< pages; 0: the default of the kind
  std::optional<std::int64_t> clips;          ///< motions of a page of real_or_fake
  std::string figure;                         ///< skin, bones; empty: bones in a ranking, else skin
  std::filesystem::path body;                 ///< of a skin; empty: found
  std::int64_t seed = 1;                      ///< of all draws
  std::vector<std::string> ask;               ///< labels to ask about; empty: all that every source has
  double seconds = 10.0;                      ///< of each motion, at most
  std::vector<std::filesystem::path> labels;  ///< of motions without labels: one for all, or for each source
  std::string source;                         ///< source declaration of files that are not datasets, or empty
  std::string extractor;                      ///< recogniser whose joints, axes and unit bare arrays have, or empty
  std::filesystem::path output;               ///< folder for survey.html and key.json
  bool force = false;                         ///< overwrite
};

struct SurveyTallyArguments {
  std::filesystem::path key;
  std::vector<std::filesystem::path> answers;
  std::string corner;            ///< origin of the motions, below the figure; or empty
  bool skip_bad = false;         ///< skip invalid files, with a warning
  std::filesystem::path output;  ///< folder for the tally's files
  bool force = false;            ///< overwrite
};

struct DatasetArguments {
  std::filesystem::path path;                ///< dataset; of a comparison: the older one
  std::filesystem::path other;               ///< the newer one; of `apply`: the decisions; of `relabel`: the map
  std::vector<std::filesystem::path> paths;  ///< of `merge`: the datasets
  std::filesystem::path output;              ///< file of the card (empty: stdout) or of the new dataset
  std::filesystem::path excluded;            ///< file for the dropped clips, or empty
  std::string where;                         ///< of `subset`: condition on clips (canon/values/where.h)
  bool drop_empty_labels = false;            ///< of `subset`: remove classes without a clip
  bool croissant = false;                    ///< JSON-LD instead of Markdown
  bool force = false;                        ///< overwrite
};

struct InspectArguments {
  std::filesystem::path path;
  std::filesystem::path source;  ///< name of a source declaration, or a config; or empty
};

struct SynthesizeArguments {
  std::filesystem::path config;  ///< options of the studio; empty: defaults
  std::string layout;            ///< empty: as in the config
  std::filesystem::path output;
  std::optional<std::int64_t> seed;
  std::vector<std::string> assignments;
  int jobs = 0;       ///< 0: one per core
  bool show = false;  ///< print the options instead
};

struct ConfigArguments {
  std::filesystem::path config;
  std::vector<std::string> assignments;
  bool origins = false;
};

struct InitConfigArguments {
  std::filesystem::path path;
  std::filesystem::path output;  ///< empty: stdout
  std::string name;              ///< of the source; empty: the folder's name
  bool force = false;
};

struct DoctorArguments {
  std::string source;          ///< source declaration or config whose files are checked; empty: the machine
  std::string protocol;        ///< whose weights are checked; empty: none
  std::filesystem::path path;  ///< folder of the captures; empty: as in the declaration
};

struct CacheArguments {
  std::string action;  ///< stat, verify, prune
  double days = 30.0;
  bool dry_run = false;  ///< prune: remove nothing
};

/// Each verb prints its result and returns its status, which determines the exit code.
/// What became of the sets of a run over several.
struct SetsOfRun {
  std::map<std::string, std::vector<std::string>> done;  ///< name -> findings about the set
  std::map<std::string, std::string> failed;             ///< name -> why
};

Status RunVerb(CommonArguments& common, const RunArguments& arguments, SetsOfRun* sets = nullptr);
Status PlanVerb(CommonArguments& common, const PlanArguments& arguments);
/// One task of a plan.
Status TaskVerb(CommonArguments& common, const RunArguments& arguments);
/// A run whose stages are arrays of Slurm: submits the first job, and follows until the run ends.
Status SlurmRunVerb(CommonArguments& common, const RunArguments& arguments, const LoadedJob& job);
Status JobsVerb(CommonArguments& common, const JobsArguments& arguments);
Status FitVerb(CommonArguments& common, const FitArguments& arguments);
Status RigAuditVerb(CommonArguments& common, const RigAuditArguments& arguments);
Status ExportVerb(CommonArguments& common, const ExportArguments& arguments);
Status GenerateVerb(CommonArguments& common, const GenerateArguments& arguments);
Status DrawVerb(CommonArguments& common, const DrawArguments& arguments);
Status ViewVerb(CommonArguments& common, const ViewArguments& arguments);
Status ReproduceVerb(CommonArguments& common, const ReproduceArguments& arguments);
Status EvalVerb(CommonArguments& common, const EvalArguments& arguments);
/// EvalVerb of fits with ground truth.
Status EvalFitsVerb(CommonArguments& common, const EvalArguments& arguments);
Status AuditVerb(CommonArguments& common, const AuditArguments& arguments);
Status ReviewVerb(CommonArguments& common, const ReviewArguments& arguments);
Status AnnotateVerb(CommonArguments& common, const ReviewArguments& arguments);
Status SurveyMakeVerb(CommonArguments& common, const SurveyMakeArguments& arguments);
Status SurveyTallyVerb(CommonArguments& common, const SurveyTallyArguments& arguments);
Status DatasetCardVerb(CommonArguments& common, const DatasetArguments& arguments);
Status DatasetDiffVerb(CommonArguments& common, const DatasetArguments& arguments);
Status DatasetApplyVerb(CommonArguments& common, const DatasetArguments& arguments);
Status DatasetMergeVerb(CommonArguments& common, const DatasetArguments& arguments);
Status DatasetSubsetVerb(CommonArguments& common, const DatasetArguments& arguments);
Status DatasetRelabelVerb(CommonArguments& common, const DatasetArguments& arguments);
Status InspectVerb(CommonArguments& common, const InspectArguments& arguments);
Status SynthesizeVerb(CommonArguments& common, const SynthesizeArguments& arguments);
Status ShowConfigVerb(CommonArguments& common, const ConfigArguments& arguments);
Status ConfigSchemaVerb(CommonArguments& common);
Status ConfigReferenceVerb(CommonArguments& common);
Status InitConfigVerb(CommonArguments& common, const InitConfigArguments& arguments);
Status DoctorVerb(CommonArguments& common);
Status DoctorSourceVerb(CommonArguments& common, const DoctorArguments& arguments);
Status DoctorProtocolVerb(CommonArguments& common, const DoctorArguments& arguments);
Status CacheVerb(CommonArguments& common, const CacheArguments& arguments);

}  // namespace mocurate
