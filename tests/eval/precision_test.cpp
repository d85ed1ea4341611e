// How exactly metrics and extractors agree with the released Python: every deviation is within the tolerance of the
// goldens, and docs/precision.md lists them. `MOCURATE_GOLDENS=GOLDENS MOCURATE_REGENERATE=1 test_eval
// --gtest_filter='Precision*'` makes the page again.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/npy.h"
#include "eval/metrics/accuracy.h"
#include "eval/metrics/feature_distances.h"
#include "eval/metrics/interval.h"
#include "tests/support/folders.h"
#include "tests/support/golden.h"
#include "tests/train/recogniser_runs.h"
#include "train/checkpoint/checkpoint.h"
#include "train/recognisers/gru_pass.h"

namespace mocurate {
namespace {

const std::filesystem::path kPage = std::filesystem::path(kSourceFolder) / "docs/precision.md";

/// One line of the page: how far our numbers lie from the released ones.
struct Deviation {
  std::string what;
  std::string golden;
  double tolerance = 0.0;  ///< absolute
  int numbers = 0;
  double largest = 0.0;

  void Compare(double ours, double released) {
    const double difference = std::fabs(ours - released);
    largest = difference <= largest ? largest : difference;  // NaN is the largest
    ++numbers;
  }
  void Compare(const std::vector<float>& ours, const std::vector<float>& released) {
    ASSERT_EQ(ours.size(), released.size()) << what;
    for (std::size_t i = 0; i < ours.size(); ++i) Compare(ours[i], released[i]);
  }
};

using Rows = std::vector<Deviation>;

Golden MetricsFile() { return Golden(golden::PathOf("metrics.h5")); }

Features AsFeatures(const golden::Array<double>& array) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(array.values.data(), static_cast<Eigen::Index>(array.rows()),
                                    static_cast<Eigen::Index>(array.row_size()));
}

std::vector<int> AsInts(const golden::Array<std::int64_t>& array) {
  return std::vector<int>(array.values.begin(), array.values.end());
}

IndexPairs AsPairs(const std::vector<int>& flat) {
  IndexPairs pairs;
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) pairs.emplace_back(flat[i], flat[i + 1]);
  return pairs;
}

/// The released code takes means of float32 features in float32, ours in double.
Rows FidRows() {
  const Golden file = MetricsFile();
  Deviation exact{"FID, float64 features, full rank", "metrics.h5 fid/*", 1e-9};
  Deviation rounded{"FID, float32 features, full rank", "metrics.h5 fid/*", 1e-5};
  Deviation deficient{"FID, fewer motions than features, or a constant feature", "metrics.h5 fid/*", 1e-5};
  for (const std::string& name : file.Children("fid")) {
    const std::string at = "fid/" + name + "/";
    const auto a = file.Doubles(at + "A"), b = file.Doubles(at + "B");
    const auto first = StatisticsOf(AsFeatures(a)), second = StatisticsOf(AsFeatures(b));
    EXPECT_TRUE(first && second) << name;
    const double ours = FrechetDistance(*first, *second).value_or(std::nan(""));
    const double size = static_cast<double>(a.row_size());
    const bool full = file.AttributeDoubles("fid/" + name, "rank_sigma_A")[0] == size &&
                      file.AttributeDoubles("fid/" + name, "rank_sigma_B")[0] == size;
    const auto is_float = [](double value) { return static_cast<double>(static_cast<float>(value)) == value; };
    const bool floats = std::all_of(a.values.begin(), a.values.end(), is_float) &&
                        std::all_of(b.values.begin(), b.values.end(), is_float);
    (!full ? deficient : floats ? rounded : exact).Compare(ours, file.Doubles(at + "fid")[0]);
  }
  return {exact, rounded, deficient};
}

Rows SpreadRows() {
  const Golden file = MetricsFile();
  Deviation diversity{"diversity, the released draws", "metrics.h5 divmm, multiact_divmm", 1e-5};
  Deviation multimodality{"multimodality, the released draws", "metrics.h5 divmm", 1e-5};
  Deviation divided{"multimodality divided by all classes (MultiAct)", "metrics.h5 multiact_divmm", 1e-5};
  const auto any_of = [&](const std::string& at) {
    const auto first = AsInts(file.Integers(at + "div_first")), second = AsInts(file.Integers(at + "div_second"));
    IndexPairs any;
    for (std::size_t i = 0; i < first.size(); ++i) any.emplace_back(first[i], second[i]);
    return any;
  };
  for (const std::string& name : file.Children("divmm")) {
    const Features features = AsFeatures(file.Doubles("divmm/" + name + "/activations"));
    for (const std::string& seed : file.Children("divmm/" + name)) {
      if (seed.rfind("seed", 0) != 0) continue;
      const std::string at = "divmm/" + name + "/" + seed + "/";
      diversity.Compare(MeanDistance(features, any_of(at)), file.Doubles(at + "diversity")[0]);
      multimodality.Compare(MeanDistance(features, AsPairs(AsInts(file.Integers(at + "mm_pairs")))),
                            file.Doubles(at + "multimodality")[0]);
    }
  }
  for (const std::string& name : file.Children("multiact_divmm")) {
    const std::string at = "multiact_divmm/" + name + "/";
    const Features features = AsFeatures(file.Doubles(at + "activations"));
    const IndexPairs same = AsPairs(AsInts(file.Integers(at + "mm_pairs")));
    const double whole = 20.0 * static_cast<double>(file.Integers(at + "num_labels")[0]);
    diversity.Compare(MeanDistance(features, any_of(at)), file.Doubles(at + "diversity")[0]);
    divided.Compare(MeanDistance(features, same) * static_cast<double>(same.size()) / whole,
                    file.Doubles(at + "multimodality")[0]);
  }
  return {diversity, multimodality, divided};
}

Rows AccuracyRows() {
  const Golden file = MetricsFile();
  Deviation accuracy{"accuracy", "metrics.h5 accuracy", 1e-12};
  const Eigen::MatrixXi confusion =
      ConfusionMatrix(AsInts(file.Integers("accuracy/true")), AsInts(file.Integers("accuracy/pred")), 12);
  const std::vector<int> actual = AsInts(file.Integers("accuracy/true"));
  std::vector<float> one_hot(actual.size() * 12, 0.0f);
  const std::vector<int> predicted = AsInts(file.Integers("accuracy/pred"));
  for (std::size_t i = 0; i < actual.size(); ++i) one_hot[i * 12 + static_cast<std::size_t>(predicted[i])] = 1.0f;
  const double right = AcceptedShare(actual, one_hot.data(), 12, 1);
  accuracy.Compare(right, file.Doubles("accuracy/a2m_trace_over_num_motions")[0]);
  Deviation rounded{"accuracy of ACTOR, float32", "metrics.h5 accuracy", 1e-7};
  rounded.Compare(right, file.Doubles("accuracy/actor_trace_over_sum")[0]);
  const auto released = file.Integers("accuracy/confusion");
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c < 12; ++c) {
      accuracy.Compare(confusion(r, c), static_cast<double>(released[static_cast<std::size_t>(r * 12 + c)]));
    }
  }
  const auto logits = file.Floats("multiact_accuracy/logits");
  const auto truth = AsInts(file.Integers("multiact_accuracy/true"));
  const auto synonyms = file.Integers("multiact_accuracy/synonyms"),
             listed = file.Integers("multiact_accuracy/has_synonyms");
  EquivalentClasses equivalent(53);
  for (std::size_t c = 0; c < 53; ++c) {
    for (std::size_t p = 0; p < 53; ++p) {
      if (listed[c] != 0 && synonyms[c * 53 + p] != 0) equivalent[c].push_back(static_cast<int>(p));
    }
  }
  const auto share = [&](const char* name) {
    return static_cast<double>(file.Integers(std::string("multiact_accuracy/") + name)[0]) /
           static_cast<double>(truth.size());
  };
  Deviation top5{"accuracy_top5", "metrics.h5 multiact_accuracy", 1e-12};
  Deviation accepted{"accuracy_equivalent (MultiAct's table)", "metrics.h5 multiact_accuracy", 1e-12};
  const float* values = logits.values.data();
  accuracy.Compare(AcceptedShare(truth, values, 53, 1), share("strict_top1"));
  top5.Compare(AcceptedShare(truth, values, 53, 5), share("strict_top5"));
  top5.Compare(AcceptedShare(truth, values, 53, 5, equivalent), share("correct_top5"));
  accepted.Compare(AcceptedShare(truth, values, 53, 1, equivalent), share("correct_top1"));
  return {accuracy, rounded, top5, accepted};
}

Rows IntervalRows() {
  const Golden file = MetricsFile();
  Deviation a2m{"interval of Action2Motion", "metrics.h5 ci/*", 1e-9};
  Deviation actor{"interval of ACTOR", "metrics.h5 ci/*", 1e-9};
  Deviation student{"interval of MultiAct", "metrics.h5 ci/*", 1e-9};
  for (const std::string& name : file.Children("ci")) {
    const std::string at = "ci/" + name + "/";
    const std::vector<double> values = file.Doubles(at + "values").values;
    const double n = static_cast<double>(values.size());  // the golden divides the variance by n - 1
    a2m.Compare(Summarise(values, IntervalKind::kAction2Motion).half_width * std::sqrt(n / (n - 1.0)),
                file.Doubles(at + "normal_halfwidth_1p96_sd_over_sqrt_n")[0]);
    actor.Compare(Summarise(values, IntervalKind::kActor).half_width, file.Doubles(at + "actor_interval")[0]);
    student.Compare(Summarise(values, IntervalKind::kStudent).half_width, file.Doubles(at + "multiact_halfwidth")[0]);
    student.Compare(Summarise(values, IntervalKind::kStudent).mean, file.Doubles(at + "mean")[0]);
  }
  return {a2m, actor, student};
}

/// Published weights, and 20 motions of the same repository that they score.
struct PublishedSet {
  std::string extractor, data, run, weights, joints;
  int frames, size, classes;
};

const PublishedSet kSets[] = {
    {"a2m-humanact12", "humanact12", "vanila_vae_tf", "action_recognition_model_humanact12.tar",
     "motion_joints500000.npy", 60, 72, 12},
    {"a2m-ntu13", "ntu_rgbd_vibe", "vanila_vae_tf_2", "action_recognition_model_vibe_v2.tar", "motion_joints300000.npy",
     60, 54, 13},
    {"a2m-cmu8", "mocap", "vanila_vae_tf_2", "action_recognition_model_mocap_new.tar", "motion_joints210000.npy", 100,
     60, 8},
};

std::vector<float> MotionsOf(const PublishedSet& set) {
  const auto bytes = ReadFile(golden::PathOf("published/" + set.data + "/" + set.run + "/" + set.joints));
  const Expected<NpyArray> array = ParseNpy(*bytes, set.joints);
  return std::vector<float>(array->values.begin(), array->values.end());
}

void PlaceAtOrigin(const PublishedSet& set, std::vector<float>& motions) {
  const std::size_t size = static_cast<std::size_t>(set.frames) * static_cast<std::size_t>(set.size);
  for (std::size_t n = 0; n < motions.size() / size; ++n) {
    const float root[3] = {motions[n * size], motions[n * size + 1], motions[n * size + 2]};
    for (std::size_t i = 0; i < size; ++i) motions[n * size + i] -= root[i % 3];
  }
}

std::unique_ptr<Recogniser> WeightsOf(const PublishedSet& set) {
  auto recogniser = Recogniser::LoadPublished(golden::PathOf("published/" + set.weights));
  EXPECT_TRUE(recogniser) << recogniser.error().Message();
  EXPECT_EQ((*recogniser)->class_count(), set.classes);
  return std::move(*recogniser);
}

/// Logits and features of the motions as stored and with the root at the origin, from zero and from drawn states.
Rows ExtractorRows() {
  const Golden file(golden::PathOf("recogniser.h5"));
  Rows rows;
  for (const PublishedSet& set : kSets) {
    const auto recogniser = WeightsOf(set);
    const auto released = ReadReleasedWeights(golden::PathOf("published/" + set.weights), kGruRecogniserKind);
    EXPECT_TRUE(released) << released.error().Message();
    const GruPass pass({set.size, set.classes}, released->parameters);
    Deviation logits{"logits of " + set.extractor, "recogniser.h5 " + set.data, 5e-5};
    Deviation features{"features of " + set.extractor, "recogniser.h5 " + set.data, 5e-5};
    std::vector<float> motions = MotionsOf(set);
    const auto compare = [&](const std::string& group, const std::string& start, const std::vector<int>& lengths) {
      auto output = RunOn(*recogniser, motions, 20, set.frames, set.size, {}, lengths);
      ASSERT_TRUE(output) << output.error().Message();
      if (start == "h0_randn") {
        const std::vector<float> drawn = file.Floats(set.data + "/h0_randn_hidden").values;
        pass.Run(motions.data(), 20, set.frames, lengths, drawn.data(), output->features.data(), output->logits.data());
      }
      const std::string at = group + "/" + start;
      logits.Compare(output->logits, file.Floats(at + "/logits").values);
      features.Compare(output->features, file.Floats(at + "/features30").values);
      if (!lengths.empty()) return;
      const auto predicted = file.Integers(at + "/pred");
      for (int i = 0; i < 20; ++i) EXPECT_EQ(Predicted(*output, i), predicted[static_cast<std::size_t>(i)]) << at;
    };
    for (const std::string start : {"h0_zero", "h0_randn"}) {
      if (&set != kSets) continue;
      std::vector<int> lengths;
      for (const std::int64_t length : file.Integers("actor_variable_length/lengths").values) {
        lengths.push_back(static_cast<int>(length));
      }
      compare("actor_variable_length", start, lengths);
    }
    for (const std::string placed : {"as_stored", "first_root_at_origin"}) {
      if (placed == "first_root_at_origin") PlaceAtOrigin(set, motions);
      for (const std::string start : {"h0_zero", "h0_randn"}) {
        compare(set.data + "/" + set.run + "/" + placed, start, {});
      }
    }
    rows.push_back(std::move(logits));
    rows.push_back(std::move(features));
  }
  return rows;
}

TEST(Extractors, RefuseMotionsOfAnotherSkeleton) {
  MOCURATE_NEEDS_GOLDENS();
  const std::vector<float> motion(60 * 54, 0.0f);
  const auto output = RunOn(*WeightsOf(kSets[0]), motion, 1, 60, 54);
  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().code, ErrorCode::kInconsistent);
}

struct Group {
  const char* name;
  Rows (*rows)();
};

class PrecisionOf : public ::testing::TestWithParam<Group> {};

constexpr Group kGroups[] = {{"Fid", FidRows},
                             {"Spread", SpreadRows},
                             {"Accuracy", AccuracyRows},
                             {"Interval", IntervalRows},
                             {"Extractors", ExtractorRows}};

TEST_P(PrecisionOf, NumbersAreThoseOfTheReleasedCode) {
  MOCURATE_NEEDS_GOLDENS();
  for (const Deviation& row : GetParam().rows()) {
    EXPECT_GT(row.numbers, 0) << row.what;
    EXPECT_LE(row.largest, row.tolerance) << row.what;
  }
}

INSTANTIATE_TEST_SUITE_P(Precision, PrecisionOf, ::testing::ValuesIn(kGroups),
                         [](const auto& group) { return group.param.name; });

std::string PageOf(const Rows& rows) {
  std::string page =
      "# How exact the metrics are\n\n"
      "Each metric and extractor on inputs whose result the papers' released Python gave: the largest deviation of\n"
      "`mocurate eval` from it, and the tolerance that `tests/eval/precision_test.cpp` enforces. Deviations differ a\n"
      "little between processors; tolerances hold on all. Draws are the released ones, so nothing here is chance.\n"
      "KID, density, coverage, `nearest_train` and the label-free measures have no released counterpart: their tests\n"
      "are properties (`tests/metrics`, `tests/quality`).\n\n"
      "`MOCURATE_GOLDENS=GOLDENS MOCURATE_REGENERATE=1 build/test/bin/test_eval --gtest_filter='Precision*'` makes\n"
      "this page again.\n\n"
      "| what | released numbers | compared | largest deviation | tolerance |\n|---|---|---|---|---|\n";
  for (const Deviation& row : rows) {
    char numbers[96];
    std::snprintf(numbers, sizeof numbers, "%d | %.1e | %.0e |\n", row.numbers, row.largest, row.tolerance);
    page += "| " + row.what + " | " + row.golden + " | " + numbers;
  }
  page +=
      "\nThe extractors' goldens are 20 published motions a set: they prove parity of the code and no row of a table.\n"
      "FID takes means in double; the released code takes those of float32 features in float32.\n";
  return page;
}

/// The page without its measured column, which differs between processors.
std::string WithoutMeasured(const std::string& page) {
  std::string kept;
  for (const std::string_view line : SplitText(page, '\n')) {
    const auto cells = SplitText(line, '|');
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells.size() == 7 && i == 4) continue;
      kept += std::string(cells[i]) + "|";
    }
    kept += "\n";
  }
  return kept;
}

TEST(Precision, ThePageListsWhatIsCompared) {
  MOCURATE_NEEDS_GOLDENS();
  Rows rows;
  for (const Group& group : kGroups) {
    for (Deviation& row : group.rows()) rows.push_back(std::move(row));
  }
  const std::string page = PageOf(rows);
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    ASSERT_TRUE(WriteFile(kPage, page));
    return;
  }
  const auto written = ReadFile(kPage);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_EQ(WithoutMeasured(*written), WithoutMeasured(page))
      << "run MOCURATE_REGENERATE=1 test_eval --gtest_filter='Precision*'";
}

}  // namespace
}  // namespace mocurate
