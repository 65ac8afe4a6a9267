#pragma once
/// A TOML text with the overrides of the command line applied, and the place of everything in it. Internal.

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <toml++/toml.h>

#include "brink/scenes/toml/faults.h"

namespace brink {

class TomlDocument {
 public:
  /// Entries of an array of tables that have no name are called by a word and their index: by the array's key.
  using DefaultNames = std::map<std::string, std::string>;

  /// Parses `text` and applies overrides ("PATH=VALUE"). Faults go to faults(); after a syntax error root()
  /// is empty.
  TomlDocument(std::string_view text, const std::vector<std::string>& overrides, DefaultNames unnamed = {});

  /// False after a syntax error: nothing else can be said about the text.
  bool readable() const { return readable_; }
  const toml::table& root() const { return root_; }
  FaultList& faults() { return faults_; }

  /// The place of a value.
  Where where(const toml::node& node) const;
  /// The place of a key (that of its value where the key has none).
  Where where(const toml::key& key, const toml::node& value) const;

 private:
  void parse(std::string_view text);
  void apply(const std::string& override_text, int index);
  void mark(const toml::node& node, int index);
  /// The table entry or array element that `part` names inside `node`, which is called `key`, or null.
  toml::node* step(toml::node& node, const std::string& key, const std::string& part);
  void assign(toml::node& parent, const std::string& part, const toml::node& value, int index);

  FaultList faults_;
  DefaultNames unnamed_;
  bool readable_ = false;
  toml::table root_;
  std::unordered_map<const toml::node*, int> override_of_;  ///< nodes that overrides brought in
};

/// What a value is, for messages: its type and, where short, the value itself.
std::string given(const toml::node& node);

}  // namespace brink
