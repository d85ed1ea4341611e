#include "core/formats/humanact12_pickle.h"

#include <utility>

#include "core/formats/array_fields.h"
#include "core/formats/pickle.h"
#include "core/formats/pickle_writer.h"

namespace mocurate {
namespace {

constexpr std::size_t kJoints = 24;
constexpr int kClasses = 12;

Expected<std::vector<double>> Take(const PickleRef& item, const std::vector<std::size_t>& wanted,
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

Expected<std::vector<HumanAct12Clip>> ParseHumanAct12Pickle(std::string_view bytes, const std::string& name) {
  const Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  const PickleRef top = pickle->top();
  const Expected<PickleRef> poses = List(top, "poses");
  if (!poses) return Forward(poses);
  const Expected<PickleRef> joints = List(top, "joints3D");
  if (!joints) return Forward(joints);
  const Expected<PickleRef> labels = List(top, "y");
  if (!labels) return Forward(labels);
  for (const PickleRef& list : {*joints, *labels}) {
    if (list.size() == poses->size()) continue;
    return list.Bad(std::to_string(list.size()) + " clips, but " + std::to_string(poses->size()) + " under 'poses'");
  }
  std::vector<HumanAct12Clip> clips;
  for (std::size_t i = 0; i < poses->size(); ++i) {
    HumanAct12Clip clip;
    Expected<std::vector<double>> taken = Take(poses->Item(i), {kAnyExtent, 3 * kJoints}, name, clip.frames);
    if (!taken) return Forward(taken);
    clip.poses = std::move(*taken);
    taken = Take(joints->Item(i), {clip.frames, kJoints, 3}, name, clip.frames);
    if (!taken) return Forward(taken);
    clip.joints = std::move(*taken);
    const Expected<std::int64_t> label = labels->Item(i).Integer();
    if (!label) return Forward(label);
    if (*label < 0 || *label >= kClasses) {
      return labels->Item(i).Bad("class " + std::to_string(*label) + " is none of 0 to 11");
    }
    clip.label = static_cast<int>(*label);
    clips.push_back(std::move(clip));
  }
  return clips;
}

Expected<std::string> EncodeHumanAct12Pickle(const std::vector<HumanAct12Clip>& clips, const std::string& name) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("poses");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Array(MakeArray({clip.frames, 3 * kJoints}, clip.poses));
  writer.End();
  writer.Text("oldposes");
  writer.BeginList();
  writer.End();
  writer.Text("joints3D");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Array(MakeArray({clip.frames, kJoints, 3}, clip.joints));
  writer.End();
  writer.Text("y");
  writer.BeginList();
  for (const HumanAct12Clip& clip : clips) writer.Integer(clip.label);
  writer.End();
  writer.End();
  return writer.Finish(name);
}

}  // namespace mocurate
