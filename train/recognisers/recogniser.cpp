#include "train/recognisers/recogniser.h"

#include <algorithm>
#include <utility>

#include "core/base/file.h"
#include "core/formats/torch_pickle.h"
#include "train/checkpoint/checkpoint.h"
#include "train/recognisers/gru_recogniser.h"

namespace mocurate {

struct Recogniser::Impl {
  GruRecogniserConfig config;
  ParameterList parameters;
  std::vector<std::string> labels;
  RecogniserInputKind input = RecogniserInputKind::kCrop;
  int frames = 60;
};

namespace {

constexpr int kRecognisedAtOnce = 128;

Expected<int> Size(const ParameterList& parameters, const std::string& name, std::size_t axis,
                   const std::string& where) {
  const int found = FindParameter(parameters, name);
  if (found < 0 || parameters[found].shape.size() <= axis || parameters[found].shape[axis] < 1 ||
      parameters[found].shape[axis] > 100000) {
    return Fail(ErrorCode::kInconsistent, "'" + name + "' is missing or has no such size: no recogniser of motions",
                where);
  }
  return static_cast<int>(parameters[found].shape[axis]);
}

// The network that fits the stored arrays.
Status Build(const ParameterList& stored, const std::string& where, GruRecogniserConfig& config,
             ParameterList& parameters) {
  const Expected<int> input = Size(stored, "recurrent.weight_ih_l0", 1, where);
  const Expected<int> hidden = Size(stored, "recurrent.weight_hh_l0", 1, where);
  const Expected<int> features = Size(stored, "linear1.weight", 0, where);
  const Expected<int> classes = Size(stored, "linear2.weight", 0, where);
  for (const Expected<int>* size : {&input, &hidden, &features, &classes}) {
    if (!*size) return Forward(*size);
  }
  config = {*input, *classes, *hidden, *features};
  parameters = GruRecogniserParameters(config);
  return CopyValues(stored, where, parameters);
}

GruRecogniserBatch MakeBatch(const float* motions, int begin, int count, int frames, int dim) {
  GruRecogniserBatch batch;
  batch.batch = count;
  batch.frames = frames;
  batch.motion.resize(static_cast<std::size_t>(count) * frames * dim);
  for (int b = 0; b < count; ++b) {
    const float* motion = motions + static_cast<std::size_t>(begin + b) * frames * dim;
    for (int t = 0; t < frames; ++t) {
      std::copy(motion + static_cast<std::size_t>(t) * dim, motion + static_cast<std::size_t>(t + 1) * dim,
                batch.motion.begin() + (static_cast<std::ptrdiff_t>(t) * count + b) * dim);
    }
  }
  return batch;
}

// Rows [begin, begin + count) of (2,n,H), or drawn ones.
std::vector<float> HiddenOf(const RecogniserHidden& hidden, int begin, int count, int total, int size) {
  if (hidden.given.empty() && hidden.kind == InitialHidden::kZero) return {};
  std::vector<float> rows(static_cast<std::size_t>(2) * count * size);
  if (!hidden.given.empty()) {
    for (int layer = 0; layer < 2; ++layer) {
      const auto first = hidden.given.begin() + (static_cast<std::ptrdiff_t>(layer) * total + begin) * size;
      std::copy(first, first + static_cast<std::ptrdiff_t>(count) * size,
                rows.begin() + static_cast<std::ptrdiff_t>(layer) * count * size);
    }
    return rows;
  }
  for (int b = 0; b < count; ++b) {
    Random random(hidden.seed, "recogniser.hidden", std::to_string(begin + b));
    for (int layer = 0; layer < 2; ++layer) {
      for (int k = 0; k < size; ++k) {
        rows[(static_cast<std::size_t>(layer) * count + b) * size + k] = static_cast<float>(random.Normal());
      }
    }
  }
  return rows;
}

}  // namespace

int RecogniserOutput::Predicted(int index) const {
  const float* row = logits.data() + static_cast<std::size_t>(index) * classes;
  return static_cast<int>(std::max_element(row, row + classes) - row);
}

Recogniser::Recogniser(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recogniser::~Recogniser() = default;

Expected<std::unique_ptr<Recogniser>> Recogniser::Load(const std::filesystem::path& path) {
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(path, kGruRecogniserKind);
  if (!checkpoint) return Forward(checkpoint);
  auto impl = std::make_unique<Impl>();
  const std::string where = DisplayPath(path);
  if (Status built = Build(checkpoint->parameters, where, impl->config, impl->parameters); !built)
    return Forward(built);
  impl->labels = checkpoint->labels;
  const Expected<RecogniserOptions> options = OptionsFromJson<RecogniserOptions>(checkpoint->options, where);
  if (!options) return Forward(options);
  impl->input = options->input;
  impl->frames = static_cast<int>(options->frames);
  if (static_cast<int>(impl->labels.size()) != impl->config.classes) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(impl->labels.size()) + " labels, but the network has " +
                    std::to_string(impl->config.classes) + " classes",
                where);
  }
  return std::unique_ptr<Recogniser>(new Recogniser(std::move(impl)));
}

Expected<std::unique_ptr<Recogniser>> Recogniser::LoadPublished(const std::filesystem::path& path) {
  const Expected<TorchTable> table = ReadTorchPickle(path);
  if (!table) return Forward(table);
  ParameterList stored;
  for (const TorchTensor& tensor : table->tensors) {
    if (tensor.name.compare(0, 6, "model/") != 0) continue;
    Parameter parameter;
    parameter.name = tensor.name.substr(6);
    parameter.shape = tensor.shape;
    parameter.value.assign(tensor.values.begin(), tensor.values.end());
    stored.push_back(std::move(parameter));
  }
  auto impl = std::make_unique<Impl>();
  if (Status built = Build(stored, DisplayPath(path), impl->config, impl->parameters); !built) return Forward(built);
  return std::unique_ptr<Recogniser>(new Recogniser(std::move(impl)));
}

Expected<RecogniserOutput> Recogniser::Run(const float* motions, int count, int frames, int dim,
                                           const RecogniserHidden& hidden, const std::vector<int>& lengths) const {
  const GruRecogniserConfig& config = impl_->config;
  if (dim != config.input) {
    return Fail(ErrorCode::kInconsistent,
                "motions have " + std::to_string(dim) + " numbers per frame, the recogniser was trained on " +
                    std::to_string(config.input),
                "recogniser", "use the skeleton it was trained on");
  }
  const bool lengths_fit =
      lengths.empty() || (static_cast<int>(lengths.size()) == count &&
                          std::all_of(lengths.begin(), lengths.end(), [&](int n) { return n >= 1 && n <= frames; }));
  if (frames < 1 || !lengths_fit ||
      (!hidden.given.empty() && hidden.given.size() != static_cast<std::size_t>(2) * count * config.hidden)) {
    return Fail(ErrorCode::kInconsistent, "frames, lengths or initial state do not fit the motions", "recogniser");
  }
  RecogniserOutput output;
  output.count = count;
  output.classes = config.classes;
  output.feature_size = config.features;
  for (int begin = 0; begin < count; begin += kRecognisedAtOnce) {
    const int size = std::min(kRecognisedAtOnce, count - begin);
    GruRecogniserBatch batch = MakeBatch(motions, begin, size, frames, dim);
    if (!lengths.empty()) batch.length.assign(lengths.begin() + begin, lengths.begin() + begin + size);
    batch.initial_hidden = HiddenOf(hidden, begin, size, count, config.hidden);
    const GruRecogniserOutput part = RunGruRecogniser(config, impl_->parameters, batch);
    output.features.insert(output.features.end(), part.features.begin(), part.features.end());
    output.logits.insert(output.logits.end(), part.logits.begin(), part.logits.end());
  }
  return output;
}

int Recogniser::input_size() const { return impl_->config.input; }
int Recogniser::class_count() const { return impl_->config.classes; }
int Recogniser::hidden_size() const { return impl_->config.hidden; }
const std::vector<std::string>& Recogniser::labels() const { return impl_->labels; }
RecogniserInputKind Recogniser::input_kind() const { return impl_->input; }
int Recogniser::input_frames() const { return impl_->frames; }

}  // namespace mocurate
