#include "canon/values/where.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>

#include "canon/splits/leaks.h"
#include "canon/values/subset.h"
#include "canon/values/where_nodes.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using Node = Condition::Node;
using Place = std::function<std::string(const Node& test)>;

/// A field of all clips.
struct FieldColumn {
  std::vector<std::string> texts;
  std::vector<double> numbers;
};

std::string TextOf(std::string_view field, const Clip& clip, const std::string& argument) {
  const ClipIdentity& identity = clip.identity;
  if (field == "id") return clip.id();
  if (field == "label") return clip.label;
  if (field == "fine_label") return clip.fine_label;
  if (field == "person") return identity.person;
  if (field == "recording") return identity.recording;
  if (field == "session") return identity.session;
  if (field == "view") return identity.view;
  if (field == "source") return identity.source;
  if (field == "role") return clip.role;
  if (field == "licence") return identity.licence;
  return clip.Noted(argument);
}

double NumberOf(std::string_view field, const Clip& clip, const std::string& argument) {
  if (field == "frames") return clip.motion ? clip.motion->frame_count() : 0;
  if (field == "seconds") return clip.motion ? clip.motion->duration() : 0.0;
  if (field == "rate") return clip.rate.hz();
  if (field == "fit_rms") return clip.fit_rms;
  if (field == "confidence") return ParseDouble(clip.Noted("cut_confidence")).value_or(1.0);
  return static_cast<double>(std::count_if(clip.segments.begin(), clip.segments.end(),
                                           [&](const Segment& segment) { return segment.label == argument; }));
}

Expected<std::vector<std::string>> PartsOfClips(const Dataset& dataset, const std::string& name,
                                                const std::string& place) {
  const Split* split = dataset.FindSplit(name);
  if (split == nullptr) {
    std::vector<std::string> names;
    for (const Split& one : dataset.splits) names.push_back(one.name);
    return Fail(ErrorCode::kUsage, "the dataset has no split '" + name + "'", place,
                DidYouMean(name, names, names.empty() ? "it has no splits" : "its splits: " + JoinTexts(names)));
  }
  std::vector<std::string> parts;
  for (const int part : PartsOf(*split, dataset.clips.size())) parts.emplace_back(NameOfPart(part));
  return parts;
}

Expected<FieldColumn> ColumnOfField(const Node& test, const Dataset& dataset, const Place& place) {
  FieldColumn column;
  const std::string_view field = test.field->name;
  if (field == "part") {
    auto parts = PartsOfClips(dataset, test.argument, place(test));
    if (!parts) return Forward(parts);
    column.texts = std::move(*parts);
  } else if (field == "findings") {
    std::map<std::string, std::vector<const Finding*>> of_recording;
    for (const Finding& finding : dataset.findings) {
      if (finding.code == test.argument) of_recording[RecordingOf(finding.clip)].push_back(&finding);
    }
    for (const Clip& clip : dataset.clips) {
      const auto found = of_recording.find(RecordingOf(clip.id()));
      column.numbers.push_back(0.0);
      if (found == of_recording.end()) continue;
      for (const Finding* finding : found->second) column.numbers.back() += IsAbout(*finding, clip) ? 1.0 : 0.0;
    }
  } else {
    for (const Clip& clip : dataset.clips) {
      if (test.field->is_text) column.texts.push_back(TextOf(field, clip, test.argument));
      if (!test.field->is_text) column.numbers.push_back(NumberOf(field, clip, test.argument));
    }
  }
  return column;
}

/// The fields of all clips that the tests of a condition look at.
class Columns {
 public:
  Columns(const Dataset& dataset, const Place& place) : dataset_(dataset), place_(place) {}

  /// Until the next call for the same field with another argument.
  Expected<const FieldColumn*> Of(const Node& test) {
    const auto known = columns_.find(test.field);
    if (known != columns_.end() && known->second.first == test.argument) return &known->second.second;
    auto column = ColumnOfField(test, dataset_, place_);
    if (!column) return Forward(column);
    auto& kept = columns_[test.field];
    kept = {test.argument, std::move(*column)};
    return &kept.second;
  }

  std::size_t rows() const { return dataset_.clips.size(); }

 private:
  const Dataset& dataset_;
  const Place& place_;
  std::map<const ConditionField*, std::pair<std::string, FieldColumn>> columns_;
};

/// `values` of a list are sorted.
template <class Value>
bool HoldsFor(const Node& test, const Value& value, const std::vector<Value>& values) {
  switch (test.test) {
    case Node::Test::kLess:
      return value < values[0];
    case Node::Test::kLessEqual:
      return value <= values[0];
    case Node::Test::kGreater:
      return value > values[0];
    case Node::Test::kGreaterEqual:
      return value >= values[0];
    default:
      break;
  }
  const bool found = std::binary_search(values.begin(), values.end(), value);
  return found == (test.test == Node::Test::kEqual || test.test == Node::Test::kIn);
}

Expected<std::vector<bool>> HoldsOfTest(const Node& test, Columns& columns) {
  const auto column = columns.Of(test);
  if (!column) return Forward(column);
  std::vector<std::string> texts = test.texts;
  std::vector<double> numbers = test.numbers;
  std::sort(texts.begin(), texts.end());
  std::sort(numbers.begin(), numbers.end());
  std::vector<bool> holds(columns.rows());
  for (std::size_t row = 0; row < holds.size(); ++row) {
    if (test.pattern) {
      holds[row] = ::regexec(test.pattern.get(), (*column)->texts[row].c_str(), 0, nullptr, 0) == 0;
    } else {
      holds[row] = test.field->is_text ? HoldsFor(test, (*column)->texts[row], texts)
                                       : HoldsFor(test, (*column)->numbers[row], numbers);
    }
  }
  return holds;
}

Expected<std::vector<bool>> HoldsOf(const Node& node, Columns& columns) {
  if (node.kind == Node::Kind::kTest) return HoldsOfTest(node, columns);
  std::vector<bool> all;
  for (const Node& part : node.parts) {
    auto holds = HoldsOf(part, columns);
    if (!holds) return holds;
    if (all.empty()) all = *holds;
    for (std::size_t row = 0; row < all.size(); ++row) {
      all[row] = node.kind == Node::Kind::kOr ? all[row] || (*holds)[row] : all[row] && (*holds)[row];
    }
  }
  if (node.kind == Node::Kind::kNot) all.flip();
  return all;
}

/// Calls `take` with every test, from left to right.
void ForEachTest(const Node& node, const std::function<void(const Node&)>& take) {
  if (node.kind == Node::Kind::kTest) take(node);
  for (const Node& part : node.parts) ForEachTest(part, take);
}

/// "--where:12", made where an error needs it: it counts the text's characters.
Place PlaceIn(const std::string& text, const std::string& place) {
  return [&](const Node& test) { return place + ":" + std::to_string(ColumnOf(text, test.begin)); };
}

}  // namespace

Expected<std::vector<bool>> Condition::Holds(const Dataset& dataset) const {
  const Place place = PlaceIn(text_, place_);
  Columns columns(dataset, place);
  return HoldsOf(*root_, columns);
}

Expected<std::vector<std::pair<std::string, std::size_t>>> Condition::CountTests(const Dataset& dataset) const {
  std::vector<std::pair<std::string, std::size_t>> counts;
  const Place place = PlaceIn(text_, place_);
  Columns columns(dataset, place);
  Status failed;
  ForEachTest(*root_, [&](const Node& test) {
    const auto holds = HoldsOfTest(test, columns);
    if (!holds) {
      failed = Forward(holds);
      return;
    }
    const auto count = static_cast<std::size_t>(std::count(holds->begin(), holds->end(), true));
    counts.emplace_back(text_.substr(test.begin, test.end - test.begin), count);
  });
  if (!failed) return Forward(failed);
  return counts;
}

std::size_t Condition::tests() const {
  std::size_t count = 0;
  ForEachTest(*root_, [&count](const Node&) { ++count; });
  return count;
}

std::vector<Condition::UnknownValue> Condition::FindUnknownValues(const Dataset& dataset) const {
  constexpr std::size_t kMostNearest = 10;
  std::vector<UnknownValue> unknown;
  if (dataset.clips.empty()) return unknown;
  const Place place = PlaceIn(text_, place_);
  Columns columns(dataset, place);
  std::map<const FieldColumn*, std::vector<std::string>> present;  // sorted, each once
  ForEachTest(*root_, [&](const Node& test) {
    if (test.texts.empty() || test.field->argument != nullptr) return;
    const auto column = columns.Of(test);
    if (!column) return;
    const auto [known, added] = present.emplace(*column, std::vector<std::string>());
    if (added) {
      const std::set<std::string> texts((*column)->texts.begin(), (*column)->texts.end());
      known->second.assign(texts.begin(), texts.end());
    }
    for (const std::string& value : test.texts) {
      if (std::binary_search(known->second.begin(), known->second.end(), value)) continue;
      unknown.push_back(
          {test.field->name, value, unknown.size() < kMostNearest ? Nearest(value, known->second) : std::nullopt});
    }
  });
  return unknown;
}

}  // namespace mocurate
