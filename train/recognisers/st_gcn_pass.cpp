#include "train/recognisers/st_gcn_pass.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr int kWindow = 9;  // frames of a convolution along time
constexpr int kPartitions = 3;

/// Arrays by name; the first that is missing or has another number of values is the error.
class Arrays {
 public:
  Arrays(const ParameterList& parameters, std::string where) : parameters_(parameters), where_(std::move(where)) {}

  bool Has(const std::string& name) const { return FindParameter(parameters_, name) >= 0; }

  std::vector<float> Take(const std::string& name, std::size_t size) {
    const int at = FindParameter(parameters_, name);
    if (at >= 0 && parameters_[static_cast<std::size_t>(at)].value.size() == size) {
      return parameters_[static_cast<std::size_t>(at)].value;
    }
    if (problem_.empty()) {
      problem_ = at < 0 ? "parameter '" + name + "' is missing"
                        : "parameter '" + name + "' has " +
                              std::to_string(parameters_[static_cast<std::size_t>(at)].value.size()) +
                              " values, the network has " + std::to_string(size);
    }
    return {};
  }

  int Rows(const std::string& name) const {
    constexpr std::int64_t kMost = 100000;
    const int at = FindParameter(parameters_, name);
    if (at < 0 || parameters_[static_cast<std::size_t>(at)].shape.empty()) return 0;
    const std::int64_t rows = parameters_[static_cast<std::size_t>(at)].shape[0];
    return rows > 0 && rows <= kMost ? static_cast<int>(rows) : 0;
  }

  Status Problem() const {
    if (problem_.empty()) return {};
    return Fail(ErrorCode::kInconsistent, problem_, where_, "use weights of an ST-GCN");
  }

 private:
  const ParameterList& parameters_;
  std::string where_, problem_;
};

/// A norm after training: x -> scale x + shift.
void TakeNorm(Arrays& arrays, const std::string& name, std::size_t channels, std::vector<float>& scale,
              std::vector<float>& shift) {
  constexpr float kEpsilon = 1e-5f;
  const std::vector<float> weight = arrays.Take(name + ".weight", channels),
                           bias = arrays.Take(name + ".bias", channels);
  const std::vector<float> mean = arrays.Take(name + ".running_mean", channels);
  const std::vector<float> variance = arrays.Take(name + ".running_var", channels);
  if (!arrays.Problem()) return;
  scale.resize(channels);
  shift.resize(channels);
  for (std::size_t c = 0; c < channels; ++c) {
    scale[c] = weight[c] / std::sqrt(variance[c] + kEpsilon);
    shift[c] = bias[c] - mean[c] * scale[c];
  }
}

/// A convolution and the norm behind it as one.
void TakeFolded(Arrays& arrays, const std::string& layer, const std::string& norm, std::size_t output,
                std::size_t columns, std::vector<float>& weight, std::vector<float>& bias) {
  std::vector<float> scale, shift;
  TakeNorm(arrays, norm, output, scale, shift);
  weight = arrays.Take(layer + ".weight", output * columns);
  bias = arrays.Take(layer + ".bias", output);
  if (!arrays.Problem()) return;
  for (std::size_t o = 0; o < output; ++o) {
    for (std::size_t k = 0; k < columns; ++k) weight[o * columns + k] *= scale[o];
    bias[o] = bias[o] * scale[o] + shift[o];
  }
}

/// result (rows, columns) = weight (rows, depth) x (depth, columns) + bias of the row, or + result.
void Product(const std::vector<float>& weight, const std::vector<float>& bias, const float* x, int depth, int columns,
             bool add, float* result) {
  const int rows = static_cast<int>(bias.size());
  for (int r = 0; r < rows; ++r) {
    float* row = result + static_cast<std::ptrdiff_t>(r) * columns;
    const float value = bias[static_cast<std::size_t>(r)];
    if (add) {
      for (int k = 0; k < columns; ++k) row[k] += value;
    } else {
      std::fill_n(row, columns, value);
    }
  }
  cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, columns, depth, 1.0f, weight.data(), depth, x, columns,
              1.0f, result, columns);
}

}  // namespace

std::vector<float> SpatialPartitions(const std::vector<int>& parents) {
  const std::size_t V = parents.size();
  std::vector<double> linked(V * V, 0.0), neighbours(V, 0.0);
  for (std::size_t v = 0; v < V; ++v) {
    linked[v * V + v] = 1.0;
    if (parents[v] < 0) continue;
    const auto parent = static_cast<std::size_t>(parents[v]);
    linked[v * V + parent] = linked[parent * V + v] = 1.0;
  }
  for (std::size_t k = 0; k < V * V; ++k) neighbours[k % V] += linked[k];
  const auto hops = [&](std::size_t v) { return v == 0 ? 0 : linked[v * V] > 0.0 ? 1 : 2; };  // 2: farther than one
  std::vector<float> partitions(kPartitions * V * V, 0.0f);
  for (std::size_t j = 0; j < V; ++j) {
    for (std::size_t i = 0; i < V; ++i) {
      const std::size_t part = j == i ? 0 : hops(j) >= hops(i) ? 1 : 2;
      partitions[(part * V + j) * V + i] = static_cast<float>(linked[j * V + i] / neighbours[i]);
    }
  }
  return partitions;
}

std::vector<int> WithoutRoot(std::vector<int> parents) {
  parents.erase(parents.begin());
  for (int& parent : parents) --parent;
  return parents;
}

Expected<StGcnPass> StGcnPass::Make(const ParameterList& parameters, const std::vector<int>& parents,
                                    const std::string& where) {
  Arrays arrays(parameters, where);
  StGcnPass pass;
  const int channels = arrays.Rows("data_bn.weight"), V = static_cast<int>(parents.size());
  if (channels != 6 * V && channels != 6 * (V - 1)) {
    return Fail(ErrorCode::kInconsistent,
                "the network reads " + std::to_string(channels) + " numbers a frame, the skeleton has " +
                    std::to_string(V) + " joints of 6",
                where, "use weights of an ST-GCN on this skeleton");
  }
  pass.joints_ = channels / 6;
  const auto joints = static_cast<std::size_t>(pass.joints_);
  const std::vector<float> partitions = SpatialPartitions(pass.joints_ == V ? parents : WithoutRoot(parents));
  TakeNorm(arrays, "data_bn", static_cast<std::size_t>(channels), pass.input_scale_, pass.input_shift_);
  std::size_t input = 6;
  for (int i = 0; arrays.Has("st_gcn_networks." + std::to_string(i) + ".gcn.conv.weight"); ++i) {
    const std::string name = "st_gcn_networks." + std::to_string(i);
    const auto output = static_cast<std::size_t>(arrays.Rows(name + ".gcn.conv.weight") / kPartitions);
    Layer layer;
    layer.input = static_cast<int>(input);
    layer.output = static_cast<int>(output);
    const bool conv = arrays.Has(name + ".residual.0.weight");
    layer.stride = conv ? 2 : 1;  // the channels grow where time is halved
    layer.adds_input = i > 0 && !conv;
    layer.graph = arrays.Take(name + ".gcn.conv.weight", kPartitions * output * input);
    layer.graph_bias = arrays.Take(name + ".gcn.conv.bias", kPartitions * output);
    layer.adjacency = arrays.Take("edge_importance." + std::to_string(i), partitions.size());
    if (Status whole = arrays.Problem(); !whole) return Forward(whole);
    for (std::size_t k = 0; k < partitions.size(); ++k) layer.adjacency[k] *= partitions[k];
    TakeNorm(arrays, name + ".tcn.0", output, layer.scale, layer.shift);
    TakeFolded(arrays, name + ".tcn.2", name + ".tcn.3", output, output * kWindow, layer.time, layer.time_bias);
    if (conv) {
      TakeFolded(arrays, name + ".residual.0", name + ".residual.1", output, input, layer.residual,
                 layer.residual_bias);
    }
    pass.layers_.push_back(std::move(layer));
    input = output;
  }
  pass.classes_ = arrays.Rows("fcn.weight");
  pass.features_ = static_cast<int>(input);
  pass.head_ = arrays.Take("fcn.weight", static_cast<std::size_t>(pass.classes_) * input);
  pass.head_bias_ = arrays.Take("fcn.bias", static_cast<std::size_t>(pass.classes_));
  if (Status whole = arrays.Problem(); !whole) return Forward(whole);
  if (pass.layers_.empty() || pass.classes_ == 0 || joints == 0) {
    return Fail(ErrorCode::kInconsistent, "the file has no ST-GCN", where, "use weights of an ST-GCN");
  }
  return pass;
}

void StGcnPass::Run(const float* motion, int frames, float* features, float* logits) const {
  const int V = joints_;
  int T = frames, C = 6;
  std::vector<float> x(static_cast<std::size_t>(C) * T * V);  // (C,T,V)
  for (int t = 0; t < T; ++t) {
    for (int v = 0; v < V; ++v) {
      for (int c = 0; c < C; ++c) {
        const int channel = 6 * v + c;
        x[(static_cast<std::size_t>(c) * T + t) * V + v] =
            motion[static_cast<std::ptrdiff_t>(t) * 6 * V + channel] * input_scale_[static_cast<std::size_t>(channel)] +
            input_shift_[static_cast<std::size_t>(channel)];
      }
    }
  }
  std::vector<float> parts, sum, columns, next, strided;
  for (const Layer& layer : layers_) {
    const int O = layer.output, cells = T * V;
    parts.resize(static_cast<std::size_t>(kPartitions) * O * cells);
    Product(layer.graph, layer.graph_bias, x.data(), C, cells, false, parts.data());
    sum.assign(static_cast<std::size_t>(O) * cells, 0.0f);
    for (int k = 0; k < kPartitions; ++k) {
      cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, O * T, V, V, 1.0f,
                  parts.data() + static_cast<std::ptrdiff_t>(k) * O * cells, V,
                  layer.adjacency.data() + static_cast<std::ptrdiff_t>(k) * V * V, V, 1.0f, sum.data(), V);
    }
    for (int o = 0; o < O; ++o) {
      const float scale = layer.scale[static_cast<std::size_t>(o)], shift = layer.shift[static_cast<std::size_t>(o)];
      float* row = sum.data() + static_cast<std::ptrdiff_t>(o) * cells;
      for (int k = 0; k < cells; ++k) row[k] = std::max(0.0f, row[k] * scale + shift);
    }
    // Rows (channel, place in the window), columns (frame, joint) of the convolution along time.
    const int after = (T + layer.stride - 1) / layer.stride, wide = after * V;
    columns.assign(static_cast<std::size_t>(O) * kWindow * wide, 0.0f);
    for (int o = 0; o < O; ++o) {
      for (int w = 0; w < kWindow; ++w) {
        float* row = columns.data() + (static_cast<std::ptrdiff_t>(o) * kWindow + w) * wide;
        for (int t = 0; t < after; ++t) {
          const int from = layer.stride * t + w - kWindow / 2;
          if (from >= 0 && from < T) {
            std::copy_n(sum.data() + static_cast<std::ptrdiff_t>(o) * cells + static_cast<std::ptrdiff_t>(from) * V, V,
                        row + static_cast<std::ptrdiff_t>(t) * V);
          }
        }
      }
    }
    next.resize(static_cast<std::size_t>(O) * wide);
    Product(layer.time, layer.time_bias, columns.data(), O * kWindow, wide, false, next.data());
    if (layer.adds_input) {
      for (std::size_t k = 0; k < next.size(); ++k) next[k] += x[k];
    } else if (!layer.residual.empty()) {
      strided.resize(static_cast<std::size_t>(C) * wide);
      for (int c = 0; c < C; ++c) {
        for (int t = 0; t < after; ++t) {
          std::copy_n(
              x.data() + (static_cast<std::ptrdiff_t>(c) * T + static_cast<std::ptrdiff_t>(layer.stride) * t) * V, V,
              strided.data() + (static_cast<std::ptrdiff_t>(c) * after + t) * V);
        }
      }
      Product(layer.residual, layer.residual_bias, strided.data(), C, wide, true, next.data());
    }
    for (float& value : next) value = std::max(0.0f, value);
    x.swap(next);
    T = after;
    C = O;
  }
  for (int c = 0; c < C; ++c) {
    double mean = 0.0;
    for (int k = 0; k < T * V; ++k) mean += x[static_cast<std::size_t>(c) * T * V + k];
    features[c] = static_cast<float>(mean / (T * V));
  }
  std::copy(head_bias_.begin(), head_bias_.end(), logits);
  cblas_sgemv(CblasRowMajor, CblasNoTrans, classes_, C, 1.0f, head_.data(), C, features, 1, 1.0f, logits, 1);
}

}  // namespace mocurate
