#include "eval/protocols/recogniser_scores.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "eval/features/feature_extractor.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/interval.h"
#include "eval/protocols/draws.h"

namespace mocurate {
namespace {

struct LabelledMotions {
  std::vector<const Motion*> motions;
  std::vector<int> labels;
};

/// The test clips; without a split all clips.
LabelledMotions TestMotions(const Dataset& dataset, const Split* split) {
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (split != nullptr) rows = split->test;
  LabelledMotions test;
  for (const int row : rows) {
    const int label = dataset.LabelIndex(dataset.clips[row].label);
    if (label < 0) continue;
    test.motions.push_back(&*dataset.clips[row].motion);
    test.labels.push_back(label);
  }
  return test;
}

nlohmann::json MatrixJson(const Eigen::MatrixXi& confusion) {
  nlohmann::json matrix = nlohmann::json::array();
  for (Eigen::Index r = 0; r < confusion.rows(); ++r) {
    matrix.push_back(nlohmann::json::array());
    for (Eigen::Index c = 0; c < confusion.cols(); ++c) matrix.back().push_back(confusion(r, c));
  }
  return matrix;
}

}  // namespace

Expected<nlohmann::json> ScoreRecognisers(const std::vector<std::filesystem::path>& checkpoints, const Dataset& dataset,
                                          const std::string& split_name) {
  const auto split = ChooseSplit(dataset, split_name);
  if (!split) return Forward(split);
  const LabelledMotions test = TestMotions(dataset, *split);
  if (test.motions.empty()) return nlohmann::json{{"test_clips", 0}, {"scored", "no clip tests"}};
  nlohmann::json names = nlohmann::json::array();
  for (const LabelName& label : dataset.labels) names.push_back(label.name);
  const int classes = static_cast<int>(dataset.labels.size());
  Eigen::MatrixXi confusion = Eigen::MatrixXi::Zero(classes, classes);
  std::vector<double> accuracies;
  for (const std::filesystem::path& checkpoint : checkpoints) {
    const auto recogniser = Recogniser::Load(checkpoint);
    if (!recogniser) return Forward(recogniser);
    const auto recognised = Recognise(**recogniser, test.motions, {}, 0);
    if (!recognised) return Forward(recognised);
    const Eigen::MatrixXi own = ConfusionMatrix(test.labels, recognised->predicted, classes);
    accuracies.push_back(Accuracy(own));
    confusion += own;
  }
  return nlohmann::json{{"test_accuracy", accuracies},
                        {"mean", Summarise(accuracies, IntervalKind::kStudent).mean},
                        {"test_clips", test.labels.size()},
                        {"scored", *split != nullptr ? "test clips" : "all clips, the dataset has no split"},
                        {"confusion", MatrixJson(confusion)},
                        {"labels", names}};
}

}  // namespace mocurate
