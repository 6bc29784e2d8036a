//! A master: it unpacks an FMU, holds an instance, and stores the logger's messages.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fs;
use std::path::Path;
use std::ptr;
use std::sync::Mutex;

use mesh_damper_fmu::contents::{Contents, MODEL, SETTINGS};
use mesh_damper_fmu::description::description;
use mesh_damper_fmu::functions::*;
use mesh_damper_fmu::types::{Callbacks, Component, Logger, SavedState, Status, ValueReference};
use mesh_damper_fmu::variables::{ACCELERATION, DISPLACEMENT, FORCE, VELOCITY};
use mesh_damper_model::export::{Export, ExportSettings};
use mesh_damper_model::file::ModelFile;

/// The references of the motion.
pub const MOTION: [ValueReference; 3] = [
    DISPLACEMENT as ValueReference,
    VELOCITY as ValueReference,
    ACCELERATION as ValueReference,
];

/// Friction that sticks, and a spring that fades.
pub const MODEL_WITH_HISTORY: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 8.0, "k3": 180.0, "c": 0.3, "alpha": 0.3 } ],
  "effects": [ { "family": "relaxation", "parameters": { "stiffness": 0.8, "time": 0.05 } },
               { "family": "stick_slip", "parameters": { "stiffness": 8.0, "slip_limit": 0.04 } } ],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-20.0, 20.0] } }"#;

/// An unpacked FMU.
pub struct Unpacked {
    pub folder: tempfile::TempDir,
    pub contents: Contents,
    pub description: String,
}

impl Unpacked {
    /// For the model in `json`, at `tick_rate` Hz.
    pub fn new(json: &str, tick_rate: f64) -> Self {
        let file = ModelFile::from_bytes("model.json", json.as_bytes()).unwrap();
        let settings = ExportSettings {
            allow_active: true,
            ..ExportSettings::at(tick_rate, "mount")
        };
        let export = Export::new(&file, &settings).unwrap();
        let (contents, [model, how]) = Contents::of_export(&file, &export, tick_rate);
        let folder = tempfile::Builder::new()
            .prefix("an fmu ")
            .tempdir()
            .unwrap();
        fs::write(folder.path().join(MODEL), model).unwrap();
        fs::write(folder.path().join(SETTINGS), how).unwrap();
        Self {
            folder,
            description: description(&contents).unwrap(),
            contents,
        }
    }

    /// The URI of the resources' folder.
    pub fn uri(&self) -> String {
        uri(self.folder.path())
    }

    /// An instance of it.
    pub fn instance(&self) -> Master {
        self.try_instance(&self.contents.guid, &self.uri()).unwrap()
    }

    /// An instance, or the logger's messages.
    pub fn try_instance(&self, guid: &str, uri: &str) -> Result<Master, String> {
        start(Some(guid), Some(uri), 1)
    }
}

pub fn uri(folder: &Path) -> String {
    format!(
        "file://{}",
        folder.display().to_string().replace(' ', "%20")
    )
}

type Said = Mutex<Vec<(c_int, String)>>;

/// Receives messages like a C logger. The message's own `%` are doubled, as for `printf`.
extern "C" fn keep(
    said: *mut c_void,
    name: *const c_char,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: `start` made it, and it lives as long as the instance does.
    let said = unsafe { &*said.cast::<Said>() };
    // SAFETY: the library's strings end in NUL.
    let [name, category, message] = [name, category, message]
        .map(|text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned());
    assert_eq!(name, "damper");
    assert!(["logStatusError", "logStatusWarning"].contains(&category.as_str()));
    let text = message.replace("%%", "%").replace("##", "#");
    said.lock().unwrap().push((status, text));
}

/// An instance of the kind `kind`; without one, the logger's messages.
pub fn start(guid: Option<&str>, uri: Option<&str>, kind: c_int) -> Result<Master, String> {
    let said = Box::new(Said::default());
    type Plain = extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char);
    // SAFETY: the logger is called without arguments beyond the named ones. On all platforms that FMI 2.0 supports, these arguments
    // are passed in the same way to a function with that many arguments and to one with more.
    let logger = unsafe { std::mem::transmute::<Plain, Logger>(keep) };
    let callbacks = Callbacks {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: ptr::from_ref(&*said).cast_mut().cast(),
    };
    let text = |text: Option<&str>| text.map(|text| CString::new(text).unwrap());
    let (guid, uri) = (text(guid), text(uri));
    let pointer = |text: &Option<CString>| text.as_ref().map_or(ptr::null(), |it| it.as_ptr());
    // SAFETY: all strings end in NUL, and the callbacks exist.
    let handle = unsafe {
        fmi2Instantiate(
            c"damper".as_ptr(),
            kind,
            pointer(&guid),
            pointer(&uri),
            &callbacks,
            0,
            1,
        )
    };
    if handle.is_null() {
        let said = said.lock().unwrap();
        assert_eq!(said.len(), 1, "{said:?}");
        return Err(said[0].1.clone());
    }
    Ok(Master { handle, said })
}

/// A master of one instance.
pub struct Master {
    pub handle: Component,
    said: Box<Said>,
}

impl Drop for Master {
    fn drop(&mut self) {
        fmi2FreeInstance(self.handle);
    }
}

impl Master {
    /// The logger's messages since the last query.
    pub fn said(&self) -> Vec<(c_int, String)> {
        std::mem::take(&mut *self.said.lock().unwrap())
    }

    /// Asserts that a call succeeded without messages.
    #[track_caller]
    pub fn well(&self, status: Status) {
        assert_eq!((status, self.said()), (Status::Ok, Vec::new()));
    }

    /// Asserts that a call was refused, with all of `parts` in its only message.
    #[track_caller]
    pub fn refused(&self, status: Status, parts: &[&str]) {
        assert_eq!(status, Status::Error);
        let said = self.said();
        assert_eq!(said.len(), 1, "{said:?}");
        assert_eq!(said[0].0, Status::Error as c_int);
        for part in parts {
            assert!(said[0].1.contains(part), "{part:?} not in {:?}", said[0].1);
        }
        // Field, value, error and remedy.
        assert!(
            said[0].1.contains(" = ") && said[0].1.contains("; "),
            "{said:?}"
        );
    }

    /// Starts at `start` s, in initialization mode.
    pub fn set_up(&self, start: f64) {
        self.well(fmi2SetupExperiment(self.handle, 0, 0.0, start, 0, 0.0));
        self.well(fmi2EnterInitializationMode(self.handle));
    }

    /// Continues up to the first step, with this motion at the start.
    pub fn begin(&self, motion: [f64; 3]) {
        self.set_up(0.0);
        self.well(self.set(&MOTION, &motion));
        self.well(fmi2ExitInitializationMode(self.handle));
    }

    pub fn set(&self, references: &[ValueReference], values: &[f64]) -> Status {
        assert_eq!(references.len(), values.len());
        // SAFETY: both are of that length.
        unsafe {
            fmi2SetReal(
                self.handle,
                references.as_ptr(),
                values.len(),
                values.as_ptr(),
            )
        }
    }

    pub fn set_slopes(
        &self,
        references: &[ValueReference],
        orders: &[c_int],
        values: &[f64],
    ) -> Status {
        assert_eq!(
            (references.len(), orders.len()),
            (values.len(), values.len())
        );
        // SAFETY: all are of that length.
        unsafe {
            fmi2SetRealInputDerivatives(
                self.handle,
                references.as_ptr(),
                values.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        }
    }

    pub fn step(&self, point: f64, size: f64) -> Status {
        fmi2DoStep(self.handle, point, size, 1)
    }

    pub fn try_get(&self, reference: ValueReference) -> (Status, f64) {
        let mut value = f64::NAN;
        // SAFETY: one reference, and room for one value.
        let status = unsafe { fmi2GetReal(self.handle, &reference, 1, &mut value) };
        (status, value)
    }

    #[track_caller]
    pub fn get(&self, reference: ValueReference) -> f64 {
        let (status, value) = self.try_get(reference);
        self.well(status);
        value
    }

    /// N
    #[track_caller]
    pub fn force(&self) -> f64 {
        self.get(FORCE)
    }

    #[track_caller]
    pub fn save(&self) -> SavedState {
        let mut saved = ptr::null_mut();
        // SAFETY: there is room for one.
        self.well(unsafe { fmi2GetFMUstate(self.handle, &mut saved) });
        assert!(!saved.is_null());
        saved
    }

    #[track_caller]
    pub fn bytes(&self, saved: SavedState) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: there is room for one.
        self.well(unsafe { fmi2SerializedFMUstateSize(self.handle, saved, &mut size) });
        let mut bytes = vec![0; size];
        // SAFETY: there is room for as many.
        self.well(unsafe { fmi2SerializeFMUstate(self.handle, saved, bytes.as_mut_ptr(), size) });
        bytes
    }

    pub fn deserialize(&self, bytes: &[u8]) -> (Status, SavedState) {
        let mut saved = ptr::null_mut();
        // SAFETY: the bytes are of that length, and there is room for one.
        let status = unsafe {
            fmi2DeSerializeFMUstate(self.handle, bytes.as_ptr(), bytes.len(), &mut saved)
        };
        (status, saved)
    }
}
