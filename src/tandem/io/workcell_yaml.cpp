#include "tandem/io/workcell_yaml.h"
