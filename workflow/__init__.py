"""What a run is made of beside the physics: its scene, files, schemas, report and process."""

from pkgutil import extend_path

# a host workflow may have a folder of this name, and modules in it
__path__ = extend_path(__path__, __name__)
