#include "core/character/gltf_read.hpp"

#include <map>
#include <set>

#include "core/character/gltf_accessor.hpp"
#include "core/format.hpp"

namespace pelt::gltf {

std::vector<int> FinishSkeleton(const Document& document, const std::vector<uint8_t>& used,
                                SkeletonImport* import, std::vector<std::string>* notes) {
  Skeleton& from = import->skeleton;
  const size_t count = from.name.size();
  const bool all = count <= kJointsPerCharacter;
  std::vector<uint8_t> kept(count, all);
  for (size_t j = count; j-- > 0;) {
    kept[j] |= used[j];
    if (kept[j] && from.parent[j] >= 0) kept[size_t(from.parent[j])] = 1;
  }
  std::vector<int> now(count, -1);
  Skeleton to;
  for (size_t j = 0; j < count; ++j) {
    if (!kept[j]) continue;
    now[j] = int(to.name.size());
    to.name.push_back(from.name[j]);
    to.parent.push_back(from.parent[j] < 0 ? -1 : now[size_t(from.parent[j])]);
    to.rest.push_back(from.rest[j]);
    to.inverse_bind.push_back(from.inverse_bind[j]);
  }
  if (to.name.size() > kJointsPerCharacter)
    Fail(document, "skins",
         Format("{} joints move vertices or what does; a character holds {}", to.name.size(),
                kJointsPerCharacter));
  if (!all)
    notes->push_back(Format("{} of {} joints move no vertex; they were left out.",
                            count - to.name.size(), count));
  for (int& joint : import->joint_of_node)
    if (joint >= 0) joint = now[size_t(joint)];
  from = std::move(to);
  std::vector<std::string*> names;
  for (std::string& name : from.name) names.push_back(&name);
  MakeNamesUnique("joint", names, notes);
  return now;
}

void MakeNamesUnique(const std::string& kind, std::vector<std::string*> names,
                     std::vector<std::string>* notes) {
  std::set<std::string> taken;
  std::map<std::string, size_t> copies;
  for (size_t n = 0; n < names.size(); ++n) {
    const bool unnamed = names[n]->empty();
    const std::string name = unnamed ? kind + " " + std::to_string(n) : *names[n];
    std::string unique = name;
    for (size_t& copy = copies[name]; taken.count(unique);)
      unique = name + " " + std::to_string(++copy + 1);
    taken.insert(unique);
    if (!unnamed && unique != name)
      notes->push_back(
          Format("two {}s are called '{}'; the second is now '{}'.", kind, name, unique));
    *names[n] = unique;
  }
}

std::string Place(const char* kind, size_t index, const std::string& name) {
  std::string place = std::string(kind) + " " + std::to_string(index);
  if (!name.empty()) place += " '" + name + "'";
  return place;
}

}  // namespace pelt::gltf
