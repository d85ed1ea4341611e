#include "core/store/feature_file.h"

#include "core/store/content_file.h"
#include "core/store/table.h"

namespace mocurate {

Status WriteFeatures(const FeatureSet& set, const std::filesystem::path& path) {
  store::Content content;
  const auto N = static_cast<std::uint64_t>(set.count());
  const auto C = static_cast<std::uint64_t>(set.class_count());
  content.Put("/features", {N, static_cast<std::uint64_t>(set.feature_size)}, set.features);
  content.Put("/logits", {N, C}, set.logits);
  content.Put("/label", {N}, std::vector<std::int32_t>(set.label.begin(), set.label.end()));
  content.Put("/clip", {N}, set.clip);
  content.Put("/classes", {C}, set.classes);
  content.Put("/pass_begin", {set.pass_begin.size()}, set.pass_begin);
  content.PutText("/about", set.about);
  for (const auto& [name, values] : set.quality) content.Put("/quality/" + name, {values.size()}, values);
  return store::WriteContent(store::FeatureSchema(), std::move(content), path);
}

Expected<FeatureSet> ReadFeatures(const std::filesystem::path& path) {
  const auto content = store::ReadContent(store::FeatureSchema(), path);
  if (!content) return Forward(content);
  FeatureSet set;
  set.feature_size = static_cast<int>(content->fields.at("/features").shape[1]);
  set.features = content->Values<float>("/features");
  set.logits = content->Values<float>("/logits");
  const auto& label = content->Values<std::int32_t>("/label");
  set.label.assign(label.begin(), label.end());
  set.clip = content->Values<std::string>("/clip");
  set.classes = content->Values<std::string>("/classes");
  set.pass_begin = content->Values<std::int64_t>("/pass_begin");
  set.about = content->Text("/about");
  const std::string quality = "/quality/";
  for (const auto& [field, array] : content->fields) {
    if (field.compare(0, quality.size(), quality) == 0) set.quality[field.substr(quality.size())] = array.as<double>();
  }
  return set;
}

}  // namespace mocurate
