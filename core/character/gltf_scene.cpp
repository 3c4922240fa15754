// Which nodes of a document are there: a file may hold several scenes, stand-ins for far away and
// nodes that belong to nothing.
// Sources: glTF 2.0, 3.5 (scenes, nodes); MSFT_lod; KHR_node_visibility.
#include "core/character/gltf_read.hpp"
#include "core/format.hpp"

namespace pelt::gltf {
namespace {

constexpr size_t kMostScenes = 64;  // that are searched for a skinned mesh

class TreeReader {
 public:
  TreeReader(const Document& document, std::vector<std::string>* notes)
      : document_(document), nodes_(document.nodes), notes_(notes) {}

  NodeTree Read() {
    FindParents();
    CutCycles();
    const std::vector<uint8_t> stands_in = FindStandIns();
    ChooseScene(stands_in);
    return std::move(tree_);
  }

 private:
  std::string PlaceOf(size_t node) const { return Place("node", node, nodes_[node].name); }
  bool Exists(int node) const { return node >= 0 && size_t(node) < nodes_.size(); }
  int& ParentOf(int node) { return tree_.parent[size_t(node)]; }

  void FindParents() {
    tree_.parent.assign(nodes_.size(), -1);
    size_t nowhere = 0, again = 0;
    for (size_t n = 0; n < nodes_.size(); ++n)
      for (const int child : nodes_[n].children) {
        if (!Exists(child))
          ++nowhere;
        else if (ParentOf(child) >= 0)
          ++again;
        else
          ParentOf(child) = int(n);
      }
    if (nowhere)
      notes_->push_back(Format("{} children of nodes do not exist; they were left out.", nowhere));
    if (again) notes_->push_back(Format("{} nodes have two parents; the first counts.", again));
  }

  // With one parent each, a node is on or below a cycle exactly if its way up never ends.
  void CutCycles() {
    std::vector<uint8_t> ends(nodes_.size(), 0);
    std::vector<uint8_t> on_way(nodes_.size(), 0);
    std::vector<int> way;
    for (size_t n = 0; n < nodes_.size(); ++n) {
      way.clear();
      for (int at = int(n); at >= 0 && !ends[size_t(at)]; at = ParentOf(at)) {
        if (on_way[size_t(at)]) {
          notes_->push_back(PlaceOf(size_t(at)) + " is its own ancestor; it was taken as a root.");
          ParentOf(at) = -1;
          break;
        }
        on_way[size_t(at)] = 1;
        way.push_back(at);
      }
      for (const int w : way) {
        ends[size_t(w)] = 1;
        on_way[size_t(w)] = 0;
      }
    }
  }

  bool IsAbove(int above, int node) {
    for (; node >= 0; node = ParentOf(node))
      if (node == above) return true;
    return false;
  }

  // The nodes that are not shown where their scene is: stand-ins and what is hidden.
  std::vector<uint8_t> FindStandIns() {
    std::vector<uint8_t> out(nodes_.size(), 0);
    for (size_t n = 0; n < nodes_.size(); ++n) {
      out[n] |= nodes_[n].hidden;
      for (const int coarser : nodes_[n].coarser)
        if (Exists(coarser) && !IsAbove(coarser, int(n))) out[size_t(coarser)] = 1;
    }
    return out;
  }

  bool IsSkinned(size_t node) const { return nodes_[node].mesh >= 0 && nodes_[node].skin >= 0; }

  // Marks what hangs on the roots; whether a skinned mesh is among it.
  bool Show(const std::vector<int>& roots, const std::vector<uint8_t>& left_out,
            size_t* meshes_left_out) {
    tree_.shown.assign(nodes_.size(), 0);
    std::vector<uint8_t> seen(nodes_.size(), 0);
    std::vector<std::pair<int, bool>> stack;  // node, whether what it hangs on is shown
    for (const int root : roots)
      if (Exists(root)) stack.emplace_back(root, true);
    bool skinned = false;
    *meshes_left_out = 0;
    while (!stack.empty()) {
      const auto [node, above] = stack.back();
      stack.pop_back();
      if (seen[size_t(node)]) continue;
      seen[size_t(node)] = 1;
      const bool shown = above && !left_out[size_t(node)];
      tree_.shown[size_t(node)] = shown;
      skinned |= shown && IsSkinned(size_t(node));
      *meshes_left_out += !shown && nodes_[size_t(node)].mesh >= 0;
      for (const int child : children_[size_t(node)]) stack.emplace_back(child, shown);
    }
    return skinned;
  }

  void ChooseScene(const std::vector<uint8_t>& left_out) {
    children_.resize(nodes_.size());
    for (size_t n = 0; n < nodes_.size(); ++n)
      if (tree_.parent[n] >= 0) children_[size_t(tree_.parent[n])].push_back(int(n));
    const std::vector<Scene>& scenes = document_.scenes;
    const size_t count = std::min(scenes.size(), kMostScenes);
    const bool named = document_.scene >= 0 && size_t(document_.scene) < scenes.size();
    const size_t first = named ? size_t(document_.scene) : 0;
    size_t stand_ins = 0;
    bool found = false;
    for (size_t i = 0; i <= count && !found && count > 0; ++i) {
      // The active one, then the others.
      const size_t s = i == 0 ? first : i - 1;
      found = Show(scenes[s].roots, left_out, &stand_ins);
      if (!found) continue;
      const std::string place = Place("scene", s, scenes[s].name);
      if (s != first) notes_->push_back(place + " was read: the active one has no skinned mesh.");
      NoteOthers(place, stand_ins);
    }
    if (!found) ShowAll(left_out, &stand_ins);
    if (stand_ins)
      notes_->push_back(
          Format("{} mesh nodes are hidden, or stand-ins for far away (MSFT_lod); "
                 "they were left out.",
                 stand_ins));
  }

  // Without scenes, or where none has a skinned mesh, all nodes are there.
  void ShowAll(const std::vector<uint8_t>& left_out, size_t* stand_ins) {
    std::vector<int> roots;
    for (size_t n = 0; n < nodes_.size(); ++n)
      if (tree_.parent[n] < 0) roots.push_back(int(n));
    const bool found = Show(roots, left_out, stand_ins);
    if (found && !document_.scenes.empty())
      notes_->push_back("No scene has a skinned mesh; the nodes outside of scenes were read.");
    if (found) return;
    *stand_ins = 0;
    tree_.shown.assign(nodes_.size(), 1);
  }

  void NoteOthers(const std::string& place, size_t stand_ins) {
    size_t outside = 0;
    for (size_t n = 0; n < nodes_.size(); ++n) outside += nodes_[n].mesh >= 0 && !tree_.shown[n];
    if (outside > stand_ins)
      notes_->push_back(Format("{} was read; {} mesh nodes outside of it were left out.", place,
                               outside - stand_ins));
  }

  const Document& document_;
  const std::vector<Node>& nodes_;
  std::vector<std::string>* notes_;
  std::vector<std::vector<int>> children_;  // of each node that are its own
  NodeTree tree_;
};

}  // namespace

NodeTree ReadTree(const Document& document, std::vector<std::string>* notes) {
  return TreeReader(document, notes).Read();
}

}  // namespace pelt::gltf
