/* Reads a robot out of a text, with the installed library of importers and the installed redman beside it. */
#include <redman/import.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  const char* text =
      "name = \"pole\"\n[[link]]\nname = \"l\"\njoint = \"j\"\nparent = \"root\"\naxis = [0, 0, 1]\n"
      "range = [-1, 1]\nmass = 1\nmoment = [1e-2, 1e-2, 1e-2, 0, 0, 0]\n";
  rdm_import* i;
  rdm_robot_def def;
  int32_t robot;
  if (rdm_import_read(&i, text, strlen(text), NULL) || rdm_robot_def_init(&def, sizeof def) ||
      rdm_import_get_robot_def(i, &def)) {
    puts(rdm_import_error());
    return 1;
  }
  if (rdm_robot_create(&robot, &def)) {
    puts(rdm_last_error());
    return 1;
  }
  rdm_import_destroy(i);
  rdm_robot_destroy(robot);
  return 0;
}
