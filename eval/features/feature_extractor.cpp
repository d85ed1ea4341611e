#include "eval/features/feature_extractor.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/base/median.h"
#include "core/base/text.h"
#include "core/motion/limbs.h"

namespace mocurate {
namespace {

std::string Plain(const std::string& label) {
  std::string plain;
  for (const char c : label) {
    if (c == ' ' || c == '_' || c == '-' || c == '/') continue;
    plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return plain;
}

/// The options stored in a checkpoint of mocurate.
void TakeFromCheckpoint(const Recogniser& recogniser, Extractor& extractor) {
  ExtractorOptions& options = extractor.rules.options;
  options.frames = recogniser.input_frames();
  options.length =
      recogniser.input_kind() == RecogniserInputKind::kResample ? LengthRule::kResample : LengthRule::kCrop;
  const bool whole = recogniser.input_kind() == RecogniserInputKind::kWhole;
  options.padding = whole ? PaddingRule::kZerosMinusRoot : PaddingRule::kRepeatLast;
  options.read_out = recogniser.reads_last_valid() ? ReadOut::kLastValid : ReadOut::kLastFrame;
  options.classes = recogniser.labels();
  options.rate_hz = recogniser.rate_hz();
  extractor.rules.skeleton = recogniser.skeleton();
  options.values = ExtractorValues::kJoints;
  if (recogniser.reads_rotations()) {
    options.values = ExtractorValues::kRotation6DRows;
    extractor.rules.root_rotation = recogniser.input_size() == 6 * recogniser.skeleton()->joint_count();
  }
  if (options.name.empty()) options.name = "own";
}

int HighestOfTrunk(const Skeleton& skeleton) {
  for (const char* name : {"head", "head_top", "neck", "nose"}) {
    if (const auto joint = skeleton.FindJoint(name)) return *joint;
  }
  return -1;
}

}  // namespace

Expected<Extractor> Extractor::Open(const ExtractorOptions& options, const std::filesystem::path& weights) {
  const std::string where = DisplayPath(weights);
  const bool graph = options.network == ExtractorNetwork::kStGcn;
  if (graph != (options.values == ExtractorValues::kRotation6DRows)) {
    return Fail(ErrorCode::kUnsupported,
                "extractor '" + options.name + "' declares values that its network cannot read", where,
                "a GRU reads joints, an ST-GCN rotation_6d_rows");
  }
  Extractor extractor;
  extractor.rules.options = options;
  if (weights.extension() == ".h5" || weights.extension() == ".safetensors") {
    auto own = Recogniser::Load(weights);
    if (!own) return Forward(own);
    if ((*own)->skeleton() == nullptr) {
      return Fail(ErrorCode::kInconsistent, "the checkpoint has no skeleton", where, "train again");
    }
    TakeFromCheckpoint(**own, extractor);
    extractor.recogniser = std::move(*own);
    return extractor;
  }
  Expected<InputRules> rules = RulesOf(options);
  if (!rules) return Forward(rules);
  auto published = Recogniser::LoadPublished(weights, graph ? rules->skeleton.get() : nullptr);
  if (!published) return Forward(published);
  if (graph) rules->root_rotation = (*published)->input_size() == 6 * rules->skeleton->joint_count();
  const Recogniser& network = **published;
  if (network.input_size() != rules->size()) {
    return Fail(ErrorCode::kInconsistent,
                "the network reads " + std::to_string(network.input_size()) + " numbers per frame, skeleton '" +
                    options.skeleton + "' has " + std::to_string(rules->size()),
                where, "use the weights of extractor '" + options.name + "'; these are of another data set");
  }
  if (network.class_count() != static_cast<int>(options.classes.size())) {
    return Fail(ErrorCode::kInconsistent,
                "the network has " + std::to_string(network.class_count()) + " classes, extractor '" + options.name +
                    "' lists " + std::to_string(options.classes.size()),
                where, "use weights trained on these labels");
  }
  extractor.rules = std::move(*rules);
  extractor.recogniser = std::move(*published);
  return extractor;
}

std::optional<int> ClassOfName(const std::vector<std::string>& classes, const std::string& label) {
  const std::string wanted = Plain(label);
  if (wanted.empty()) return std::nullopt;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (Plain(classes[c]) == wanted) return static_cast<int>(c);
  }
  return std::nullopt;
}

std::optional<int> ClassOf(const std::vector<std::string>& classes, const std::string& label) {
  if (const auto named = ClassOfName(classes, label)) return named;
  const std::optional<long long> index = ParseInteger(label);
  if (index && *index >= 0 && *index < static_cast<long long>(classes.size())) return static_cast<int>(*index);
  return std::nullopt;
}

Status AppendFeatures(const Extractor& extractor, const std::vector<const Motion*>& motions,
                      const std::vector<int>& labels, const std::vector<std::string>& clips, const PassOptions& pass,
                      FeatureSet& set) {
  InputRules rules = extractor.rules;
  rules.unit_from_metres = rules.unit_from_metres * ExpMatrix(Vector3d(0.0, pass.yaw_rad, 0.0));
  std::map<const Skeleton*, std::vector<int>> joints;
  for (const Motion* motion : motions) {
    if (joints.count(motion->skeleton.get()) > 0) continue;
    auto found = JointsFor(*rules.skeleton, *motion->skeleton);
    if (!found) return Forward(found);
    joints[motion->skeleton.get()] = std::move(*found);
  }
  for (std::size_t i = 0; rules.options.values != ExtractorValues::kJoints && i < motions.size(); ++i) {
    Status rotations = CheckRotations(*rules.skeleton, *motions[i]);
    if (rotations) continue;
    return Fail(rotations.error().code, rotations.error().what, clips[i], rotations.error().hint);
  }
  RecogniserHidden hidden;
  hidden.kind = pass.hidden;
  hidden.seed = pass.seed;
  const auto count = static_cast<int>(motions.size());
  const auto size = static_cast<std::ptrdiff_t>(rules.frames()) * rules.size();
  std::vector<char> finite(motions.size());
  const auto write = [&](int begin, int end, float* values, int* read_out) {
    for (int n = begin; n < end; ++n, values += size) {
      const auto i = static_cast<std::size_t>(n);
      Random random(pass.seed, "crop", std::to_string(i));
      read_out[n - begin] = WriteMotionInput(rules, joints.at(motions[i]->skeleton.get()), *motions[i], pass.root,
                                             pass.start, random, values);
      finite[i] = std::all_of(values, values + size, [](float value) { return std::isfinite(value); }) ? 1 : 0;
    }
  };
  const auto output = extractor.recogniser->Run(write, count, rules.frames(), rules.size(), hidden, pass.threads);
  const auto broken = std::find(finite.begin(), finite.end(), 0);
  if (output && broken != finite.end()) {
    return Fail(ErrorCode::kInconsistent, "a joint position is not a finite number",
                clips[static_cast<std::size_t>(broken - finite.begin())], "remove the motion from the set");
  }
  if (!output) return Forward(output);
  const auto all_finite = [](const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  };
  if (!all_finite(output->features) || !all_finite(output->logits)) {
    return Fail(ErrorCode::kInconsistent, "the network's output is not finite", extractor.rules.options.name,
                "its training diverged, or its file is damaged: use another network");
  }
  set.pass_begin.push_back(set.count());
  set.feature_size = output->feature_size;
  set.classes = extractor.rules.options.classes;
  set.features.insert(set.features.end(), output->features.begin(), output->features.end());
  set.logits.insert(set.logits.end(), output->logits.begin(), output->logits.end());
  set.label.insert(set.label.end(), labels.begin(), labels.end());
  set.clip.insert(set.clip.end(), clips.begin(), clips.end());
  return {};
}

Status CheckFrameOfSet(const std::vector<const Motion*>& motions, double largest_scale) {
  constexpr double kLeastUpright = 0.25;  // minimum vertical share of the distance between head and feet
  std::vector<double> heights, upright, scales;
  for (const Motion* motion : motions) {
    const Skeleton& skeleton = *motion->skeleton;
    const int head = HighestOfTrunk(skeleton);
    const Limbs limbs = LimbsOf(skeleton);
    if (head >= 0 && limbs.leg[0].end >= 0 && limbs.leg[1].end >= 0) {
      const Vector3d body = motion->joints.at(0, head) -
                            0.5 * (motion->joints.at(0, limbs.leg[0].end) + motion->joints.at(0, limbs.leg[1].end));
      heights.push_back(body.y());
      upright.push_back(body.y() / std::max(1e-9, body.norm()));
    }
    std::vector<double> ratios;
    for (int j = 1; j < skeleton.joint_count(); ++j) {
      const Joint& joint = skeleton.joints[static_cast<std::size_t>(j)];
      const double rest = joint.rest_offset.norm();
      if (rest < 0.05) continue;  // the ratio of short bones is unreliable
      ratios.push_back((motion->joints.at(0, j) - motion->joints.at(0, joint.parent)).norm() / rest);
    }
    if (!ratios.empty()) scales.push_back(Median(std::move(ratios)));
  }
  if (!heights.empty() && Median(heights) <= 0.0) {
    return Fail(ErrorCode::kInconsistent,
                "the head lies " + RoundedText(-Median(heights), 3) +
                    " m below the feet in the first frame of half of "
                    "the motions",
                "frame of the set",
                "the vertical axis differs from the declared one, or the values are not positions: declare the axes "
                "with --source, or "
                "use --values lie with --bone-lengths");
  }
  if (!upright.empty() && Median(upright) < kLeastUpright) {
    return Fail(ErrorCode::kInconsistent,
                "head and feet lie at about the same height in the first frame of half of the motions: " +
                    RoundedText(Median(upright), 2) + " of their distance is vertical (rule: at least " +
                    RoundedText(kLeastUpright, 2) + ")",
                "frame of the set", "the vertical axis differs from the declared one: declare the axes with --source");
  }
  if (scales.empty()) return {};
  const double scale = Median(scales);
  if (scale <= largest_scale && scale >= 1.0 / largest_scale) return {};
  return Fail(
      ErrorCode::kInconsistent,
      "bones are " + RoundedText(scale, 3) + " times as long as those of the skeleton (rule: at most " +
          RoundedText(largest_scale, 3) + " times, or 1 / that)",
      "unit of the set",
      "another unit than declared, or values that are not positions: declare the unit with --source, or use --values "
      "lie with --bone-lengths");
}

}  // namespace mocurate
