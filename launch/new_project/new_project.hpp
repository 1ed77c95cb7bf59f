// `tandem new participant`: a small project with a solver that takes part in runs, from the templates of the
// participant kit.
//
// share/tandem/templates/LANGUAGE-ROLE has what differs between languages, share/tandem/templates/ROLE what
// does not; a file that is in both is taken from the first. A language with such a folder can be chosen
// without a change here. In each file @NAME@ becomes the name, and @PREFIX@ the folder in which tandem is
// installed.
#pragma once

#include <filesystem>
#include <string>

namespace tandem::launch {

struct NewParticipant {
  std::string name;              // of the project and of its program
  std::string language;          // "cpp", "c", "fortran" and what else has templates
  std::string role;              // "mbd" or "dem"
  std::filesystem::path folder;  // new; empty: one with the name, here
};

// Writes the project and says what to type next. Throws Error{usage} for a folder that exists, a name that
// CMake or the shell would not take, and a language without templates.
void new_participant(const NewParticipant& wanted);

}  // namespace tandem::launch
