#include "core/formats/humanact12_pickle.h"

#include <utility>

#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"

namespace mocurate {
namespace {

constexpr std::size_t kSmplJoints = 24;

Expected<std::vector<double>> TakeArray(const PickleRef& item, const std::vector<std::size_t>& wanted,
                                        const std::string& name, std::size_t& frames) {
  Expected<NpyArray> array = item.Array();
  if (!array) return Forward(array);
  if (Status s = CheckField(*array, wanted, name + ":" + item.path()); !s) return Forward(s);
  if (array->shape[0] == 0) return item.Bad("the clip has no frames");
  frames = array->shape[0];
  return std::move(array->values);
}

Expected<PickleRef> List(const PickleRef& top, const char* key) {
  Expected<PickleRef> list = top.Key(key);
  if (!list) return list;
  if (list->kind() != PickleKind::kList)
    return list->Bad(std::string("a list is expected, not ") + KindName(list->kind()));
  return list;
}

}  // namespace

Expected<HumanAct12Archive> HumanAct12Archive::Open(std::string_view bytes, const std::string& name) {
  Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  HumanAct12Archive archive;
  archive.pickle_ = std::move(*pickle);
  const PickleRef top = archive.pickle_.top();
  const Expected<PickleRef> poses = List(top, "poses");
  if (!poses) return Forward(poses);
  archive.size_ = poses->size();
  if (const auto labels = top.Find("labels"); labels && labels->kind() == PickleKind::kList) {
    archive.classes_ = static_cast<int>(labels->size());
  }
  for (const char* key : {"joints3D", "y"}) {
    const Expected<PickleRef> list = List(top, key);
    if (!list) return Forward(list);
    if (list->size() == archive.size_) continue;
    return list->Bad(std::to_string(list->size()) + " clips, but " + std::to_string(archive.size_) + " under 'poses'");
  }
  return archive;
}

Expected<int> HumanAct12Archive::Label(std::size_t clip) const {
  const PickleRef item = pickle_.top().Find("y")->Item(clip);
  const Expected<std::int64_t> label = item.Integer();
  if (!label) return Forward(label);
  if (*label < 0 || *label >= classes_) {
    return item.Bad("class " + std::to_string(*label) + " is outside 0 to " + std::to_string(classes_ - 1));
  }
  return static_cast<int>(*label);
}

Expected<HumanAct12Clip> HumanAct12Archive::Clip(std::size_t index) const {
  const PickleRef top = pickle_.top();
  HumanAct12Clip clip;
  Expected<std::vector<double>> taken =
      TakeArray(top.Find("poses")->Item(index), {kAnyExtent, 3 * kSmplJoints}, pickle_.name, clip.frames);
  if (!taken) return Forward(taken);
  clip.poses = std::move(*taken);
  taken = TakeArray(top.Find("joints3D")->Item(index), {clip.frames, kSmplJoints, 3}, pickle_.name, clip.frames);
  if (!taken) return Forward(taken);
  clip.joints = std::move(*taken);
  const Expected<int> label = Label(index);
  if (!label) return Forward(label);
  clip.label = *label;
  return clip;
}

Expected<std::string> EncodeHumanAct12Pickle(const std::vector<HumanAct12Clip>& clips, const std::string& name) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("poses");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Array(MakeArray({clip.frames, 3 * kSmplJoints}, clip.poses));
  writer.End();
  writer.Text("oldposes");
  writer.BeginList();
  writer.End();
  writer.Text("joints3D");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Array(MakeArray({clip.frames, kSmplJoints, 3}, clip.joints));
  writer.End();
  writer.Text("y");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Integer(clip.label);
  writer.End();
  writer.End();
  return writer.Finish(name);
}

}  // namespace mocurate
