#include "train/checkpoint/checkpoint.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/formats/torch_pickle.h"

namespace mocurate {
namespace {

/// Parts of a released dictionary and the network's names for them (a2m_actor.md B.6, D.1).
using NameMap = std::vector<std::pair<std::string, std::string>>;

NameMap NamesOfKind(const std::string& kind) {
  if (kind == kAction2MotionKind) {
    return {{"prior_net/", "prior."}, {"posterior_net/", "posterior."}, {"decoder/", "decoder."}};
  }
  if (kind == kGruRecogniserKind) return {{"model/", ""}};
  if (kind == kStGcnKind) return {{"model/", ""}, {"", ""}};
  return {{"", ""}};  // a plain state_dict
}

}  // namespace

Expected<ReleasedWeights> ReadReleasedWeights(const std::filesystem::path& path, const std::string& kind) {
  if (path.extension() == ".h5" || path.extension() == ".safetensors") {
    Expected<Checkpoint> checkpoint = ReadCheckpoint(path, kind);
    if (!checkpoint) return Forward(checkpoint);
    return ReleasedWeights{std::move(checkpoint->parameters), checkpoint->step};
  }
  const Expected<TorchTable> table = ReadTorchPickle(path);
  if (!table) return Forward(table);
  const NameMap names = NamesOfKind(kind);
  ReleasedWeights weights;
  for (const TorchTensor& tensor : table->tensors) {
    for (const auto& [theirs, ours] : names) {
      if (tensor.name.compare(0, theirs.size(), theirs) != 0) continue;
      Parameter parameter;
      parameter.name = ours + tensor.name.substr(theirs.size());
      parameter.shape = tensor.shape;
      parameter.value.assign(tensor.values.begin(), tensor.values.end());
      weights.parameters.push_back(std::move(parameter));
      break;
    }
  }
  if (weights.parameters.empty()) {
    std::string wanted;
    for (const auto& [theirs, ours] : names) wanted += (wanted.empty() ? "'" : ", '") + theirs + "'";
    return Fail(ErrorCode::kInconsistent, "the file has no weights of '" + kind + "'", DisplayPath(path),
                "its tensors must be below " + wanted);
  }
  if (const auto steps = table->numbers.find("iterations");
      steps != table->numbers.end() && steps->second >= 0.0 && steps->second < 1e12) {
    weights.steps = std::llround(steps->second);
  }
  return weights;
}

}  // namespace mocurate
