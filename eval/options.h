#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/motion/action_parts.h"
#include "core/motion/one_euro.h"
#include "core/quality/padding.h"
#include "eval/metrics/interval.h"

namespace mocurate {

/// Networks that compute features.
enum class ExtractorNetwork {
  kGru,    ///< Action2Motion's recogniser, and MultiAct's (a2m_actor.md D.1, multiact.md E)
  kStGcn,  ///< ACTOR's for UESTC
};
/// Network input of a frame.
enum class ExtractorValues { kJoints, kRotation6DRows };
/// Origin of the joint positions (a2m_actor.md D.8).
enum class RootRule {
  kAsGiven,
  kFirstFrame,  ///< the root of the first frame that is read
  kEveryFrame,  ///< the root of each frame: no trajectory
};
/// How a motion of another length is converted to `frames`.
enum class LengthRule {
  kCrop,      ///< a window; shorter motions are padded
  kResample,  ///< the whole motion, evenly spaced in time
};
enum class PaddingRule {
  kRepeatLast,
  kZeros,
  kZerosMinusRoot,  ///< zeros from which the root rule subtracts the root as well (MultiAct)
};
/// Output of the recurrent network that is used.
enum class ReadOut {
  kLastFrame,  ///< after the padding
  kLastValid,  ///< of the last frame that is not padding (ACTOR)
};
/// Bone lengths of the joints.
enum class BodyRule {
  kOwn,
  kMeanShape,  ///< SMPL with beta = 0 (ACTOR); without SMPL's files joints are read as given, and the result reports it
};

/// A network and the conversion of motions to its input. Motions are in the canonical world (metres, y up, facing +z);
/// the network's own frame is given by `axes` and `metres_per_unit`.
struct ExtractorOptions {
  std::string name;
  std::string weights;  ///< file below MOCURATE_WEIGHTS, or a path; a checkpoint of mocurate contains the other options
  std::string obtain;
  ExtractorNetwork network = ExtractorNetwork::kGru;
  ExtractorValues values = ExtractorValues::kJoints;
  std::string skeleton;
  std::string axes = "+x +y +z";
  double metres_per_unit = 1.0;
  double rate_hz = 0.0;  ///< of the training motions; 0: unknown
  std::int64_t frames = 60;
  LengthRule length = LengthRule::kCrop;
  PaddingRule padding = PaddingRule::kRepeatLast;
  ReadOut read_out = ReadOut::kLastFrame;
  RootRule real_root = RootRule::kFirstFrame;
  RootRule generated_root = RootRule::kFirstFrame;
  BodyRule body = BodyRule::kOwn;
  double yaw_rad = 0.0;              ///< rotation of scored motions, not of the reference, about the vertical
  std::vector<std::string> classes;  ///< in the order of the network's outputs

  void Declare(OptionVisitor& v);
};

/// Frequencies of generated labels: A2M draws them uniformly, ACTOR copies the real set's (F6).
enum class LabelDraw { kUniform, kNatural };

/// Which clips are the real motions. The papers use the whole set for training and scoring (F10).
enum class RealPart { kAll, kTrain, kTest };

/// Initial hidden states of a recurrent extractor: normal as released (F5), or zero, the same each time.
enum class HiddenDraw { kZero, kNormal };

/// Measures of single motions: ours, or MBench's five joint measures as well, for comparison with its tables.
enum class MeasureSet { kOwn, kMBench };

/// Where a window of a longer motion starts: at the first frame, or drawn (F15).
enum class CropDraw { kFirst, kReleased, kAny };

/// The draws of a repetition. The defaults draw nothing: each motion is scored once.
struct DrawOptions {
  std::int64_t repetitions = 1;
  std::int64_t motions = 0;    ///< of a set and repetition; 0: each motion once
  bool replacement = true;     ///< real motions of a repetition
  std::int64_t per_label = 0;  ///< maximum of each label in a set and repetition; 0: no limit
  LabelDraw labels = LabelDraw::kUniform;
  HiddenDraw hidden = HiddenDraw::kZero;
  CropDraw crop = CropDraw::kFirst;
  IntervalKind interval = IntervalKind::kStudent;

  void Declare(OptionVisitor& v);
};

/// Divisor of multimodality where a class has no motions: either no value, or the sum over the existing classes divided
/// by all (MultiAct).
enum class MultimodalityDivisor { kPresent, kAll };

/// Sizes of the metrics.
struct MetricOptions {
  std::int64_t diversity_pairs = 200;
  std::int64_t multimodality_quota = 20;
  MultimodalityDivisor divisor = MultimodalityDivisor::kPresent;
  double least_movement = 0.25;  ///< of a real motion's of the same label: a row below it hardly moves

  void Declare(OptionVisitor& v);
};

/// Requests for generators: a label and a length; transition and action of a sample, after its own or a generated
/// previous motion; or a chain of steps with drawn actions (multiact.md A.5).
enum class ScriptDraw { kNone, kAfterSample, kAfterGenerated, kChain };

/// Rows that say what a number means: training clips of the label; training clips of any label; the mean pose of the
/// label's training clips, standing still.
enum class Yardstick { kNone, kRetrieval, kShuffledLabels, kMeanPose };

enum class ProtocolVariant { kGiven, kReleased, kPaper };

/// Protocol of a paper. `given` scores each motion once, with nothing drawn; `released` follows the paper's code,
/// `paper` its text where the two differ.
struct ProtocolOptions {
  std::string name;
  std::string paper;
  std::string dataset;    ///< by its name in the published tables
  std::string recipe;     ///< of the real motions
  std::string extractor;  ///< a name below configs/extractors, or a YAML file
  ProtocolVariant variant = ProtocolVariant::kGiven;
  std::int64_t seed = 1;
  bool test_reference = false;       ///< FID against the test part of the real motions as well
  std::string split;                 ///< of the parts; empty: the first one
  ClipPart part = ClipPart::kWhole;  ///< scored part of samples of two actions
  DrawOptions given, released, from_paper;
  MetricOptions metrics;
  MeasureSet measures = MeasureSet::kOwn;
  std::map<std::string, std::string> equivalent;  ///< class -> accepted classes, separated by ", "
  std::vector<double> original_clips;             ///< sizes of the papers' own real set
  bool original_data = false;                     ///< the real motions are the papers' own
  std::vector<std::string> notes;

  const DrawOptions& draw() const;
  void Declare(OptionVisitor& v);
};

/// A row of a table of MultiAct: its networks and their requests.
struct ScriptRowOptions {
  std::string name;
  std::string network;  ///< macvae, or an actor whose motions are joined
  ScriptDraw script = ScriptDraw::kAfterSample;
  std::string first;       ///< actor that generates the first action where `network` is a macvae
  std::string fill;        ///< ssmct that fills transitions; empty: interpolation
  bool align = false;      ///< rotate and move joined motions
  std::int64_t steps = 1;  ///< of a chain, a row each

  void Declare(OptionVisitor& v);
};

/// A row of a network's motions after a filter.
struct FilterRowOptions {
  std::string name;
  std::string network;
  OneEuro filter;

  void Declare(OptionVisitor& v);
};

/// Evaluation of a run by its own recogniser.
struct EvaluateOptions {
  std::int64_t seed = 1;
  std::string published;                ///< set whose published numbers are listed below the table; empty: none
  std::string paper = "Action2Motion";  ///< paper of the published numbers
  std::string table;                    ///< which of its tables; empty: all
  std::string recogniser;               ///< name of the network for the features; empty: the first recogniser
  bool generators = true;               ///< generators and real motions are rows; else only recognisers are scored
  std::string protocol;  ///< a name below configs/protocols, whose equivalent labels and divisor apply; or empty
  /// A name below configs/protocols whose extractor scores the rows as well, where its weights are at hand; or empty.
  std::string published_protocol;
  std::vector<FilterRowOptions> filters;  ///< rows beside those of the networks
  std::vector<ScriptRowOptions> rows;     ///< empty: each generator is one, with requests by label
  ClipPart part = ClipPart::kWhole;       ///< scored part of samples of two actions
  bool requests_of_test = false;          ///< requests for generators are drawn from the test part
  bool yardsticks = false;                ///< rows of each Yardstick
  RealPart real = RealPart::kAll;
  bool test_reference = false;  ///< the references are the training and the test part, with an FID against each
  double settled = 0.1;         ///< largest relative change of the FID since the last sample of a converged network
  /// Of real motions: a recogniser below it makes a table void. The papers' recognise 0.93 to 1 of theirs, but
  /// MultiAct's 0.68 of its test part.
  double least_real_accuracy = 0.9;
  std::string split;  ///< of the parts; empty: the first one
  std::int64_t repetitions = 20;
  std::int64_t motions = 3000;
  bool replacement = true;                          ///< real motions of a repetition (ACTOR: without)
  RootRule real_root = RootRule::kFirstFrame;       ///< of real motions as the recogniser reads them
  RootRule generated_root = RootRule::kFirstFrame;  ///< of generated ones
  std::vector<double> durations;                    ///< requested frames, a row each; empty: the recogniser's
  std::int64_t diversity_pairs = 200;
  std::int64_t multimodality_quota = 20;
  MeasureSet measures = MeasureSet::kOwn;
  LabelDraw labels = LabelDraw::kUniform;
  IntervalKind interval = IntervalKind::kStudent;
  bool random_hidden = false;  ///< recogniser starts from normal hidden states, as released (F5)

  DrawOptions draw() const;
  MetricOptions metrics() const;
  void Declare(OptionVisitor& v);
};

/// Notes below a run's table about its scoring: sentences.
std::vector<std::string> NotesOf(const EvaluateOptions& options);

/// One set of motions through an extractor: options of the stage `features`.
struct FeaturesOptions {
  ExtractorOptions extractor;
  bool generated = false;    ///< the extractor's root rule for generated motions applies
  bool known_frame = false;  ///< a network of the run generated the set: its frame is known
  RealPart part = RealPart::kAll;
  std::string split;
  std::int64_t seed = 1;
  std::string purpose;       ///< key of the draws: sets of one purpose and seed draw alike
  std::int64_t passes = 0;   ///< 0: one pass over the motions in their order
  std::int64_t motions = 0;  ///< drawn for each pass; 0: all, in their order
  bool replacement = true;
  std::int64_t per_label = 0;
  LabelDraw labels = LabelDraw::kUniform;  ///< of a generator's requests
  HiddenDraw hidden = HiddenDraw::kZero;
  CropDraw crop = CropDraw::kFirst;
  ClipPart clip_part = ClipPart::kWhole;
  Yardstick yardstick = Yardstick::kNone;  ///< in the place of a generator
  ScriptDraw script = ScriptDraw::kNone;
  std::int64_t steps = 1;   ///< of a chain
  std::int64_t step = 1;    ///< the scored one
  bool align = false;       ///< rotate and move joined motions
  std::int64_t frames = 0;  ///< requested from a generator and read from its motions; 0: the extractor's
  OneEuro filter;           ///< of a generator's motions
  MeasureSet measures = MeasureSet::kOwn;
  PaddingAction padding = PaddingAction::kNone;  ///< all-zero frames at the end of a dataset's motions

  void Declare(OptionVisitor& v);
};

/// Whether a row is real motions itself, and the reference that contains them.
enum class RealRow { kNone, kTrain, kTest };

/// One row of a table: options of the stage `score`.
struct ScoreOptions {
  std::string name;
  RealRow real = RealRow::kNone;  ///< reference that contains them: two halves where nothing is drawn
  std::int64_t seed = 1;
  DrawOptions draw;
  MetricOptions metrics;
  std::map<std::string, std::string> equivalent;

  void Declare(OptionVisitor& v);
};

}  // namespace mocurate
