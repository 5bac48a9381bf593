#include "tandem/robot/model.h"
