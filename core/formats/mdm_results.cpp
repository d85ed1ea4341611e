#include "core/formats/mdm_results.h"

#include <utility>

#include "core/formats/array_elements.h"
#include "core/formats/array_fields.h"

namespace mocurate {
namespace {

/// The dictionary in an array of one object.
Expected<PickleRef> DictionaryIn(const Pickle& pickle) {
  const PickleRef top = pickle.top();
  if (top.kind() == PickleKind::kDict) return top;
  if (top.kind() == PickleKind::kArray && top.value().children.size() == 1) {
    PickleRef item(pickle, top.value().children[0], top.path());
    if (item.kind() == PickleKind::kList && item.size() == 1) item = item.Item(0);
    if (item.kind() == PickleKind::kDict) return item;
  }
  return top.Bad("a dictionary is expected, as MDM's sample/generate.py writes it");
}

}  // namespace

NpyArray FramesFirst(const NpyArray& array, std::size_t frames) {
  const std::size_t joints = array.shape[0], all = array.shape[2];
  NpyArray turned;
  turned.dtype = array.dtype;
  turned.shape = {frames, joints, 3};
  turned.values.resize(frames * joints * 3);
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t f = 0; f < frames; ++f) {
        turned.values[(f * joints + j) * 3 + k] = array.values[(j * 3 + k) * all + f];
      }
    }
  }
  return turned;
}

Expected<MdmResults> MdmResults::Open(std::string_view bytes, const std::string& name) {
  const Expected<std::string_view> pickled = PickleOfNpy(bytes, name);
  if (!pickled) return Forward(pickled);
  Expected<Pickle> pickle = ParsePickle(*pickled, name);
  if (!pickle) return Forward(pickle);
  MdmResults results;
  results.pickle_ = std::move(*pickle);
  const Expected<PickleRef> dictionary = DictionaryIn(results.pickle_);
  if (!dictionary) return Forward(dictionary);
  const Expected<PickleRef> motions = dictionary->Key("motion");
  if (!motions) return Forward(motions);
  const PickleArray* layout = motions->Layout();
  if (layout == nullptr || layout->shape.size() != 4 || layout->shape[2] != 3 || layout->shape[3] == 0) {
    return motions->Bad("an array (motions, joints, 3, frames) is expected");
  }
  const std::size_t count = layout->shape[0], frames = layout->shape[3];
  results.motions_ = motions->position();
  results.joints_ = layout->shape[1];
  results.lengths_.assign(count, frames);
  if (const auto lengths = dictionary->Find("lengths")) {
    const Expected<NpyArray> array = lengths->Array();
    if (!array) return Forward(array);
    if (array->values.size() != count) return lengths->Bad(std::to_string(count) + " lengths are expected");
    const auto whole = WholeNumbers(*array, 1, static_cast<std::int64_t>(frames), name + ":lengths");
    if (!whole) return Forward(whole);
    for (std::size_t i = 0; i < count; ++i) results.lengths_[i] = static_cast<std::size_t>((*whole)[i]);
  }
  results.labels_.assign(count, "");
  if (const auto texts = dictionary->Find("text"); texts && texts->kind() == PickleKind::kList) {
    if (texts->size() != count) return texts->Bad(std::to_string(count) + " texts are expected");
    for (std::size_t i = 0; i < count; ++i) {
      const Expected<std::string> text = texts->Item(i).Text();
      if (!text) return Forward(text);
      results.labels_[i] = *text;
    }
  }
  return results;
}

Expected<NpyArray> MdmResults::Motion(std::size_t motion) const {
  const Expected<NpyArray> entry = PickleRef(pickle_, motions_, "motion").ArrayEntry(motion);
  if (!entry) return Forward(entry);
  return FramesFirst(*entry, lengths_[motion]);
}

}  // namespace mocurate
