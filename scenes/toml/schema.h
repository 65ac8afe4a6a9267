#pragma once
/// Schemas: each table of the scene file is declared once, key by key, bound to a plain struct. From that one
/// declaration come reading, unknown keys, defaults, `brink list options` and the options of a run file.
/// Internal.

#include <algorithm>
#include <utility>

#include "brink/scenes/toml/codec.h"
#include "brink/scenes/toml/option_info.h"

namespace brink {

/// A value with its place in the file; `given` is false where the file says nothing.
template <class V>
struct Given {
  V value = blank<V>();
  Where where;
  bool given = false;
  bool faulty =
      false;  ///< the file says something else than it may, which has been told; `given` is false then
};

/// JSON has no word for an infinite time.
inline std::string default_text(const Json& json) {
  const std::string text = json.dump();
  return text == "null" ? "no end" : text;
}

template <class T>
class Schema {
 public:
  /// `table` is how messages and lists name it: "solver", "disc".
  explicit Schema(std::string table) : table_(std::move(table)) {}
  const std::string& table() const { return table_; }

  /// A key with the default that its member has in T{}.
  template <class V>
  Schema& key(const std::string& name, V T::*member, Codec<V> codec, const std::string& meaning) {
    return add({name, codec.type, default_text(codec.write(T{}.*member)), meaning, false,
                [=](const toml::node& node, TomlDocument& doc, T& out) {
                  V value = blank<V>();
                  if (codec.read(node, doc, name, value)) out.*member = std::move(value);
                },
                [=](const T& from) { return codec.write(from.*member); }});
  }

  /// The same for an integer member of another width.
  template <class V>
  requires std::is_integral_v<V> Schema& count(const std::string& name, V T::*member,
                                               Codec<std::int64_t> codec, const std::string& meaning) {
    return add({name, codec.type, std::to_string(T{}.*member), meaning, false,
                [=](const toml::node& node, TomlDocument& doc, T& out) {
                  std::int64_t value = 0;
                  if (codec.read(node, doc, name, value)) out.*member = static_cast<V>(value);
                },
                [=](const T& from) { return Json(from.*member); }});
  }

  /// A key that may be left out and whose place is kept; `otherwise` says for people what happens without it.
  template <class V>
  Schema& optional(const std::string& name, Given<V> T::*member, Codec<V> codec, const std::string& otherwise,
                   const std::string& meaning) {
    return add(
        {name, codec.type, otherwise, meaning, false,
         [=](const toml::node& node, TomlDocument& doc, T& out) {
           V value = blank<V>();
           const bool good = codec.read(node, doc, name, value);
           if (good) (out.*member).value = std::move(value);
           (out.*member).where = doc.where(node);
           (out.*member).given = good;
           (out.*member).faulty = !good;
         },
         [=](const T& from) { return (from.*member).given ? codec.write((from.*member).value) : Json(); }});
  }

  /// A key that must be there.
  template <class V>
  Schema& required(const std::string& name, V T::*member, Codec<V> codec, const std::string& meaning) {
    key(name, member, std::move(codec), meaning);
    keys_.back().fallback = "needed";
    keys_.back().required = true;
    return *this;
  }

  /// A key read in its own way.
  Schema& custom(const std::string& name, const std::string& type, const std::string& otherwise,
                 const std::string& meaning, std::function<void(const toml::node&, TomlDocument&, T&)> read) {
    return add({name, type, otherwise, meaning, false, std::move(read), nullptr});
  }

  /// The keys of another struct that is a member of this one.
  template <class U>
  Schema& nested(U T::*member, const Schema<U>& schema) {
    for (const auto& key : schema.keys())
      add({key.name, key.type, key.fallback, key.meaning, key.required,
           [=](const toml::node& node, TomlDocument& doc, T& out) { key.read(node, doc, out.*member); },
           [=](const T& from) { return key.write(from.*member); }});
    return *this;
  }

  /// A key of before, which is now a fault that names the new one; `but`: what else has changed.
  Schema& former(const std::string& name, const std::string& now, const std::string& but = "") {
    former_.push_back({name, "is called \"" + now + "\" now" + but});
    return *this;
  }

  /// Reads every key of `table` into `out`; unknown and missing keys are faults. `place` is where the table
  /// stands.
  void read(const toml::table& table, const Where& place, TomlDocument& doc, T& out) const {
    for (const auto& [name, node] : table) {
      if (const Key* key = find(name.str()))
        key->read(node, doc, out);
      else
        unknown(name, node, doc);
    }
    for (const Key& key : keys_)
      if (key.required && !table.contains(key.name))
        doc.faults().add(place,
                         table_ + ": " + key.name + " is missing; given nothing, allowed: " + key.type);
  }

  /// The same for any node: not a table is a fault.
  bool read_node(const toml::node& node, TomlDocument& doc, T& out) const {
    if (const toml::table* table = node.as_table()) return read(*table, doc.where(node), doc, out), true;
    doc.faults().add(doc.where(node),
                     fault_text(table_, "wrong type", given(node), "a table of " + listed(key_names())));
    return false;
  }

  /// A schema as the codec of a nested table.
  Codec<T> codec() const {
    return {"{" + listed(key_names()) + "}",
            [*this](const toml::node& node, TomlDocument& doc, const std::string&, T& out) {
              const std::size_t before = doc.faults().size();
              read_node(node, doc, out);
              return doc.faults().size() == before;
            },
            [*this](const T& from) { return json(from); }};
  }

  Json json(const T& from) const {
    Json out = Json::object();
    for (const Key& key : keys_)
      if (key.write) out[key.name] = key.write(from);
    return out;
  }

  void list(std::vector<OptionInfo>& out) const {
    for (const Key& key : keys_) out.push_back({table_, key.name, key.type, key.fallback, key.meaning});
  }

  std::vector<std::string> key_names() const {
    std::vector<std::string> out;
    for (const Key& key : keys_) out.push_back(key.name);
    return out;
  }

  struct Key {
    std::string name, type, fallback, meaning;
    bool required = false;
    std::function<void(const toml::node&, TomlDocument&, T&)> read;
    std::function<Json(const T&)> write;
  };
  const std::vector<Key>& keys() const { return keys_; }

 private:
  Schema& add(Key key) {
    keys_.push_back(std::move(key));
    return *this;
  }

  const Key* find(std::string_view name) const {
    for (const Key& key : keys_)
      if (key.name == name) return &key;
    return nullptr;
  }

  void unknown(const toml::key& name, const toml::node& node, TomlDocument& doc) const {
    const auto before =
        std::find_if(former_.begin(), former_.end(), [&](const auto& f) { return f.first == name.str(); });
    if (before != former_.end())
      return doc.faults().add(doc.where(name, node),
                              "key " + in_quotes(name.str()) + " in " + table_ + " " + before->second);
    doc.faults().add(doc.where(name, node), "unknown key " + in_quotes(name.str()) + " in " + table_ +
                                                "; the nearest known key is \"" +
                                                nearest_word(name.str(), key_names()) + "\"");
  }

  std::string table_;
  std::vector<Key> keys_;
  std::vector<std::pair<std::string, std::string>> former_;  ///< keys of before, and what is said of them
};

}  // namespace brink
