#include "canon/exports/layout.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

using C = ClipContent;

constexpr std::array<std::pair<ClipContent, const char*>, 9> kContentNames = {{{C::kRotations, "rotations"},
                                                                               {C::kBoneLengths, "bone lengths"},
                                                                               {C::kFineLabel, "fine labels"},
                                                                               {C::kSegments, "segments"},
                                                                               {C::kSession, "sessions"},
                                                                               {C::kView, "views"},
                                                                               {C::kStates, "states of the joints"},
                                                                               {C::kUncertainty, "uncertainty"},
                                                                               {C::kContacts, "foot contacts"}}};

bool Holds(const Clip& clip, ClipContent content) {
  const Motion& motion = *clip.motion;
  switch (content) {
    case C::kRotations:
    case C::kBoneLengths:
      return !motion.joints_only();
    case C::kFineLabel:
      return !clip.fine_label.empty();
    case C::kSegments:
      return !clip.segments.empty();
    case C::kSession:
      return !clip.identity.session.empty();
    case C::kView:
      return !clip.identity.view.empty();
    case C::kStates:
      return !motion.state.empty();
    case C::kUncertainty:
      return !motion.position_cov.empty() || !motion.rotation_sigma.empty();
    case C::kContacts:
      return !motion.contact.empty();
  }
  return false;
}

}  // namespace

bool Layout::Is(LayoutTrait trait) const { return std::find(traits.begin(), traits.end(), trait) != traits.end(); }

bool Layout::Carries(ClipContent content) const {
  return std::find(carries.begin(), carries.end(), content) != carries.end();
}

const std::vector<Layout>& Layouts() {
  using T = LayoutTrait;
  static const std::vector<Layout> layouts = {
      {"npz",
       "arrays of numpy, a .npz per clip",
       ".npz",
       {T::kRepresentations},
       {C::kRotations, C::kBoneLengths, C::kFineLabel, C::kStates, C::kUncertainty, C::kContacts},
       MakeNpzLayout},
      {"humanact12",
       "HumanAct12's .npy files: joints, y down; the file names hold the rest",
       "",
       {},
       {C::kFineLabel},
       MakeHumanAct12Layout},
      {"actor",
       "ACTOR's pickle of all clips: SMPL rotations, joints, classes",
       ".pkl",
       {T::kNeedsRotations, T::kAllInOneFile},
       {C::kRotations, C::kBoneLengths},
       MakeActorLayout},
      {"amass_babel",
       "AMASS's .npz (SMPL-H) with BABEL's labels and split",
       "",
       {T::kNeedsRotations, T::kOneSplit},
       {C::kRotations, C::kSegments},
       MakeAmassBabelLayout},
      {"csv", "tables of joint positions, a .csv per clip", ".csv", {}, {C::kFineLabel}, MakeCsvLayout},
      {"bvh",
       "BVH on each person's bones, a .bvh per clip",
       ".bvh",
       {T::kNeedsRotations},
       {C::kRotations, C::kBoneLengths, C::kFineLabel},
       MakeBvhLayout},
      {"c3d", "joints as points of a .c3d per clip, mm", ".c3d", {}, {C::kFineLabel, C::kStates}, MakeC3dLayout},
      {"trc", "joints as markers of a .trc per clip, mm", ".trc", {}, {C::kFineLabel, C::kStates}, MakeTrcLayout},
      {"glb",
       "glTF with bones, animation and a body of capsules, a .glb per clip (Blender)",
       ".glb",
       {T::kNeedsRotations},
       {C::kRotations, C::kBoneLengths, C::kFineLabel},
       MakeGlbLayout}};
  return layouts;
}

const Layout* FindLayout(std::string_view name) {
  const auto found =
      std::find_if(Layouts().begin(), Layouts().end(), [&](const Layout& layout) { return layout.name == name; });
  return found == Layouts().end() ? nullptr : &*found;
}

void NotCarried::Count(const Clip& clip) {
  for (std::size_t i = 0; i < kContentNames.size(); ++i) {
    if (Holds(clip, kContentNames[i].first)) ++clips_[i];
  }
}

std::string NotCarried::Note() const {
  std::string note;
  for (std::size_t i = 0; i < kContentNames.size(); ++i) {
    const auto& [content, name] = kContentNames[i];
    if (clips_[i] == 0 || layout_.Carries(content)) continue;
    note += (note.empty() ? "not carried by " + std::string(layout_.name) + ": " : std::string(", ")) + name + " of " +
            Counted(clips_[i], "clip");
  }
  return note;
}

}  // namespace mocurate
