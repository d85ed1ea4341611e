#include "train/recognisers/recogniser.h"

#include <optional>
#include <utility>

#include "core/base/file.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "train/checkpoint/checkpoint.h"
#include "train/recognisers/gru_pass.h"
#include "train/recognisers/st_gcn_pass.h"

namespace mocurate {

struct Recogniser::Impl {
  GruRecogniserConfig config;
  ParameterList parameters;
  std::vector<std::string> labels;
  SkeletonPtr skeleton;
  std::string dataset_sha256;
  RecogniserInputKind input = RecogniserInputKind::kCrop;
  bool last_valid = false;
  int frames = 60;
  double rate_hz = 0.0;
  std::optional<StGcnPass> graph;  ///< instead of the GRU: `config` has its sizes
};

namespace {

constexpr int kRecognisedAtOnce = 256;  // fastest of the widths 64 to 512
constexpr int kGraphsAtOnce = 8;        // motions of an ST-GCN, which runs them one by one

std::vector<int> ParentsOf(const Skeleton& skeleton) {
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) parents.push_back(joint.parent);
  return parents;
}

Status BuildGraph(const ParameterList& stored, const Skeleton& skeleton, const std::string& where,
                  std::optional<StGcnPass>& graph, GruRecogniserConfig& config) {
  Expected<StGcnPass> pass = StGcnPass::Make(stored, ParentsOf(skeleton), where);
  if (!pass) return Forward(pass);
  config = {6 * pass->joints(), pass->classes(), 0, 0, pass->features()};
  graph = std::move(*pass);
  return {};
}

Expected<int> Size(const ParameterList& parameters, const std::string& name, std::size_t axis,
                   const std::string& where) {
  const int found = FindParameter(parameters, name);
  if (found < 0 || parameters[found].shape.size() <= axis || parameters[found].shape[axis] < 1 ||
      parameters[found].shape[axis] > 100000) {
    return Fail(ErrorCode::kInconsistent, "'" + name + "' is missing or has another size: not a recogniser of motions",
                where);
  }
  return static_cast<int>(parameters[found].shape[axis]);
}

// The network that fits the stored arrays.
Status Build(const ParameterList& stored, const std::string& where, GruRecogniserConfig& config,
             ParameterList& parameters) {
  const Expected<int> input = Size(stored, "recurrent.weight_ih_l0", 1, where);
  const Expected<int> hidden = Size(stored, "recurrent.weight_hh_l0", 1, where);
  int layers = 1;
  while (FindParameter(stored, "recurrent.weight_hh_l" + std::to_string(layers)) >= 0) ++layers;
  const Expected<int> features = Size(stored, "linear1.weight", 0, where);
  const Expected<int> classes = Size(stored, "linear2.weight", 0, where);
  for (const Expected<int>* size : {&input, &hidden, &features, &classes}) {
    if (!*size) return Forward(*size);
  }
  config = {*input, *classes, *hidden, layers, *features};
  parameters = GruRecogniserParameters(config);
  for (Parameter& parameter : parameters) {
    const int found = FindParameter(stored, parameter.name);
    if (found < 0) return Fail(ErrorCode::kInconsistent, "parameter '" + parameter.name + "' is missing", where);
    if (stored[found].shape != parameter.shape) {
      return Fail(ErrorCode::kInconsistent,
                  "parameter '" + parameter.name + "' is " + ShapeText(stored[found].shape) + ", the network has " +
                      ShapeText(parameter.shape),
                  where);
    }
    parameter.value = stored[found].value;
  }
  return {};
}

// States (layers,count,H) of motions from `begin` on; empty: zero.
std::vector<float> HiddenOf(const RecogniserHidden& hidden, int layers, int begin, int count, int size) {
  if (hidden.kind == InitialHidden::kZero) return {};
  std::vector<float> rows(static_cast<std::size_t>(layers) * count * size);
  for (int b = 0; b < count; ++b) {
    Random random(hidden.seed, "recogniser.hidden", std::to_string(begin + b));
    for (int layer = 0; layer < layers; ++layer) {
      for (int k = 0; k < size; ++k) {
        rows[(static_cast<std::size_t>(layer) * count + b) * size + k] = static_cast<float>(random.Normal());
      }
    }
  }
  return rows;
}

}  // namespace

Recogniser::Recogniser(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recogniser::~Recogniser() = default;

Expected<std::unique_ptr<Recogniser>> Recogniser::Load(const std::filesystem::path& path) {
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(path);
  if (!checkpoint) return Forward(checkpoint);
  auto impl = std::make_unique<Impl>();
  const std::string where = DisplayPath(path);
  const bool graph = checkpoint->kind == kStGcnKind;
  if (!graph && checkpoint->kind != kGruRecogniserKind) {
    return Fail(ErrorCode::kInconsistent,
                "the checkpoint holds a network of kind '" + checkpoint->kind + "', 'gru_recogniser' is needed", where,
                "use the checkpoint of a recogniser, gru_recogniser or st_gcn");
  }
  if (graph && checkpoint->skeleton == nullptr) {
    return Fail(ErrorCode::kMalformed, "the checkpoint has no skeleton", where, "train again");
  }
  Status built = graph ? BuildGraph(checkpoint->parameters, *checkpoint->skeleton, where, impl->graph, impl->config)
                       : Build(checkpoint->parameters, where, impl->config, impl->parameters);
  if (!built) return Forward(built);
  impl->labels = checkpoint->labels;
  impl->skeleton = checkpoint->skeleton;
  impl->dataset_sha256 = checkpoint->dataset_sha256;
  const Expected<NetworkOptions> options = OptionsFromJson<NetworkOptions>(checkpoint->options, where);
  if (!options) return Forward(options);
  impl->input = options->data.input;
  impl->last_valid = options->recogniser.read_out == ReadOutChoice::kLastValid;
  impl->frames = static_cast<int>(options->data.frames);
  if (const auto rate = FrameRate::Parse(checkpoint->facts.value("rate", std::string()))) impl->rate_hz = rate->hz();
  if (static_cast<int>(impl->labels.size()) != impl->config.classes) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(impl->labels.size()) + " labels, but the network has " +
                    std::to_string(impl->config.classes) + " classes",
                where);
  }
  return std::unique_ptr<Recogniser>(new Recogniser(std::move(impl)));
}

Expected<std::unique_ptr<Recogniser>> Recogniser::LoadPublished(const std::filesystem::path& path,
                                                                const Skeleton* skeleton) {
  const Expected<ReleasedWeights> released =
      ReadReleasedWeights(path, skeleton != nullptr ? kStGcnKind : kGruRecogniserKind);
  if (!released) return Forward(released);
  auto impl = std::make_unique<Impl>();
  const std::string where = DisplayPath(path);
  Status built = skeleton != nullptr ? BuildGraph(released->parameters, *skeleton, where, impl->graph, impl->config)
                                     : Build(released->parameters, where, impl->config, impl->parameters);
  if (!built) return Forward(built);
  return std::unique_ptr<Recogniser>(new Recogniser(std::move(impl)));
}

Expected<RecogniserOutput> Recogniser::Run(const MotionWriter& write, int count, int frames, int dim,
                                           const RecogniserHidden& hidden, int threads) const {
  const GruRecogniserConfig& config = impl_->config;
  if (dim != config.input) {
    return Fail(ErrorCode::kInconsistent,
                "motions have " + std::to_string(dim) + " numbers per frame, the recogniser was trained on " +
                    std::to_string(config.input),
                "recogniser", "use the skeleton it was trained on");
  }
  RecogniserOutput output;
  output.count = count;
  output.classes = config.classes;
  output.feature_size = config.features;
  output.features.resize(static_cast<std::size_t>(count) * config.features);
  output.logits.resize(static_cast<std::size_t>(count) * config.classes);
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(frames) * dim;
  if (impl_->graph) {
    ParallelFor(count, kGraphsAtOnce, threads, [&](int begin, int end) {
      std::vector<float> values(static_cast<std::size_t>((end - begin) * stride));
      std::vector<int> read_out(static_cast<std::size_t>(end - begin));
      write(begin, end, values.data(), read_out.data());
      for (int n = begin; n < end; ++n) {
        impl_->graph->Run(values.data() + (n - begin) * stride, frames,
                          output.features.data() + static_cast<std::ptrdiff_t>(n) * config.features,
                          output.logits.data() + static_cast<std::ptrdiff_t>(n) * config.classes);
      }
    });
    return output;
  }
  const GruPass pass(config, impl_->parameters);
  ParallelFor(count, kRecognisedAtOnce, threads, [&](int begin, int end) {
    const std::unique_ptr<float[]> values(new float[static_cast<std::size_t>((end - begin) * stride)]);
    std::vector<int> read_out(static_cast<std::size_t>(end - begin));
    write(begin, end, values.get(), read_out.data());
    const std::vector<float> state = HiddenOf(hidden, config.layers, begin, end - begin, config.hidden);
    pass.Run(values.get(), end - begin, frames, read_out, state.empty() ? nullptr : state.data(),
             output.features.data() + static_cast<std::ptrdiff_t>(begin) * config.features,
             output.logits.data() + static_cast<std::ptrdiff_t>(begin) * config.classes);
  });
  return output;
}

bool Recogniser::reads_rotations() const { return impl_->graph.has_value(); }
int Recogniser::input_size() const { return impl_->config.input; }
int Recogniser::class_count() const { return impl_->config.classes; }
SkeletonPtr Recogniser::skeleton() const { return impl_->skeleton; }
const std::string& Recogniser::dataset_sha256() const { return impl_->dataset_sha256; }
const std::vector<std::string>& Recogniser::labels() const { return impl_->labels; }
double Recogniser::rate_hz() const { return impl_->rate_hz; }
RecogniserInputKind Recogniser::input_kind() const { return impl_->input; }
bool Recogniser::reads_last_valid() const { return impl_->last_valid; }
int Recogniser::input_frames() const { return impl_->frames; }

}  // namespace mocurate
